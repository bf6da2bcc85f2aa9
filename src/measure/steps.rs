//! How even the outline of a surface is along its edges: steps where the clip curve of one splat ends beside that of
//! the next ([`curve_ends`](crate::model::curve_ends)).

use super::measures::Steps;
use crate::model::asset::Asset;
use crate::model::clip_curve::Conic;
use crate::model::curve_ends::{ends, step};
use crate::model::neighbours::neighbours;
use crate::model::splat::Splat;
use crate::tolerance::STEP_SHARE;

/// The steps of an asset's outline, in model units; `None` where clip partners cut, which have no ends.
pub(super) fn steps(asset: &Asset) -> Option<Steps> {
    if asset.splats.iter().any(|splat| !splat.partners.is_empty()) {
        return None;
    }
    let conics: Vec<Vec<Conic>> = asset.splats.iter().map(Splat::conics).collect();
    let mut near: Vec<Vec<u32>> = vec![Vec::new(); asset.splats.len()];
    for [a, b] in neighbours(&asset.splats) {
        near[a as usize].push(b);
        near[b as usize].push(a);
    }
    let mut found = Steps::default();
    for (index, splat) in asset.splats.iter().enumerate() {
        for end in ends(splat, &conics[index]) {
            let others = near[index].iter().map(|&other| other as usize);
            let others = others.map(|other| (&asset.splats[other], conics[other].as_slice()));
            // Beside nothing the surface ends with the curve.
            let step = step(&end, others, asset.max_error).unwrap_or(0.0);
            found.ends += 1;
            found.uneven += u64::from(step > STEP_SHARE * asset.max_error);
            found.max = found.max.max(step);
        }
    }
    Some(found)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use glam::{DVec2, DVec3};

    use super::*;
    use crate::measure::planted::{asset, flat};
    use crate::model::clip_curve::ClipCurve;

    /// Discs of radius 1, a half apart, cut by chords so many bounds above the x axis.
    fn found(out: &[f64]) -> Option<Steps> {
        let mut asset = asset(Vec::new());
        let disc = |(n, out): (usize, &f64)| {
            let angle = libm::asin(out * asset.max_error);
            let center = 0.5 * n as f64 * DVec3::X;
            flat(center, DVec2::ONE, vec![ClipCurve::chord(angle, PI - angle)])
        };
        asset.splats = out.iter().enumerate().map(disc).collect();
        steps(&asset)
    }

    #[test]
    fn an_outline_steps_where_the_curve_farther_out_ends_beside_another() {
        let bound = asset(Vec::new()).max_error;
        let even = found(&[0.0, 0.05, 0.0]).unwrap_or_default();
        assert_eq!((even.ends, even.uneven), (6, 0));
        assert!((even.max / bound - 0.05).abs() < 1e-6, "{even:?}");
        let uneven = found(&[0.0, 0.6, 0.2]).unwrap_or_default();
        assert_eq!((uneven.ends, uneven.uneven), (6, 2), "both ends of the second");
        assert!((uneven.max / bound - 0.6).abs() < 1e-6, "{uneven:?}");
    }
}
