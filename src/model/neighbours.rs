//! Splats that are near enough to meet.

use super::splat::Splat;

/// Pairs of splats, each ascending and all in order, whose centres are nearer than their radii
/// reach together (equation 1 of the paper, which prints the sign the other way round).
#[must_use]
pub fn neighbours(splats: &[Splat]) -> Vec<[u32; 2]> {
    neighbours_up_to(splats, usize::MAX).unwrap_or_default()
}

/// The same, unless there are more: where thousands of splats lie in one heap each meets all, and what is done for each
/// pair never ends.
#[must_use]
pub fn neighbours_up_to(splats: &[Splat], most: usize) -> Option<Vec<[u32; 2]>> {
    let reach: Vec<f64> = splats.iter().map(Splat::bounding_radius).collect();
    let low = |n: u32| splats[n as usize].center.x - reach[n as usize];
    let mut order: Vec<u32> = (0..splats.len() as u32).collect();
    order.sort_by(|&a, &b| low(a).total_cmp(&low(b)).then(a.cmp(&b)));
    let mut pairs = Vec::new();
    for (at, &a) in order.iter().enumerate() {
        let (splat, high) = (&splats[a as usize], splats[a as usize].center.x + reach[a as usize]);
        for &b in order[at + 1..].iter().take_while(|&&b| low(b) < high) {
            let together = reach[a as usize] + reach[b as usize];
            if splat.center.distance_squared(splats[b as usize].center) < together * together {
                if pairs.len() == most {
                    return None;
                }
                pairs.push([a.min(b), a.max(b)]);
            }
        }
    }
    pairs.sort_unstable();
    Some(pairs)
}
