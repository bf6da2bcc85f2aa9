//! The distinct points of a cloud, in an order that does not depend on the input's.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::canonical;
use crate::model::cloud::Cloud;

/// Points of a cloud, each place once, in canonical order.
#[derive(Clone, Debug, Default)]
pub struct Distinct {
    /// Positions in model units.
    pub positions: Vec<Vec3>,
    /// Unit normals, zero where the file's is unsound; or empty.
    pub normals: Vec<Vec3>,
    /// Colours; or empty.
    pub colors: Vec<[u8; 3]>,
    /// For each point of the cloud, which of these it became.
    pub place: Vec<u32>,
}

/// Normals shorter than this say nothing. Sound ones are about 1 long, but some files scale
/// them, so the limit is far below.
const SHORTEST_NORMAL: f64 = 1e-12;

/// Sorts the points of a cloud and merges those of equal position.
///
/// Where merged points differ in normal or colour, each different pair counts once in the
/// mean, so that repeating points changes nothing.
#[must_use]
pub fn distinct(cloud: &Cloud) -> Distinct {
    let normal = |v: u32| cloud.normals.get(v as usize).map_or(Vec3::ZERO, |&n| sound(n));
    let color = |v: u32| cloud.colors.get(v as usize).copied().unwrap_or_default();
    let said = |v: u32| ((normal(v) + Vec3::ZERO).to_array().map(f32::to_bits), color(v));
    let mut order = canonical::order(&cloud.positions);
    let mut found = Distinct { place: vec![0; order.len()], ..Distinct::default() };
    let sorted: Vec<Vec3> = order.par_iter().map(|&v| cloud.positions[v as usize] + Vec3::ZERO).collect();
    let mut rest = order.as_mut_slice();
    for alike in sorted.chunk_by(|a, b| a == b) {
        let (same, others) = std::mem::take(&mut rest).split_at_mut(alike.len());
        rest = others;
        for &v in &*same {
            found.place[v as usize] = found.positions.len() as u32;
        }
        found.positions.push(alike[0]);
        same.sort_unstable_by_key(|&v| said(v));
        // The first of those that say the same; most are alone.
        let different = || same.chunk_by(|&a, &b| said(a) == said(b)).map(|alike| alike[0]);
        if !cloud.normals.is_empty() {
            let sum: DVec3 = different().map(|v| normal(v).as_dvec3()).sum();
            let alike = different().nth(1).is_none();
            found.normals.push(if alike { normal(same[0]) } else { sound(sum.as_vec3()) });
        }
        if !cloud.colors.is_empty() {
            found.colors.push(mean(different().map(color)));
        }
    }
    found
}

/// A normal of unit length; zero if it is not finite or too short.
fn sound(normal: Vec3) -> Vec3 {
    let normal = normal.as_dvec3();
    let length = normal.length();
    if length > SHORTEST_NORMAL && length.is_finite() { (normal / length).as_vec3() } else { Vec3::ZERO }
}

fn mean(colors: impl Iterator<Item = [u8; 3]>) -> [u8; 3] {
    let (mut sum, mut count) = ([0_u32; 3], 0);
    for color in colors {
        for (sum, channel) in sum.iter_mut().zip(color) {
            *sum += u32::from(channel);
        }
        count += 1;
    }
    sum.map(|sum| ((sum + count / 2) / count.max(1)) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neither_order_nor_repetition_changes_the_points() {
        let value = |n: u64| (canonical::mix(n) >> 40) as f32 / (1 << 23) as f32 - 1.0;
        let vector = |n: u64| Vec3::new(value(3 * n), value(3 * n + 1), value(3 * n + 2));
        let mut points: Vec<(Vec3, Vec3, [u8; 3])> =
            (0..500).map(|n| (vector(n % 400), vector(n + 1000), [n as u8, 7, (n / 3) as u8])).collect();
        points[3].1 = Vec3::NAN;
        let cloud = |points: &[(Vec3, Vec3, [u8; 3])]| Cloud {
            positions: points.iter().map(|p| p.0).collect(),
            normals: points.iter().map(|p| p.1).collect(),
            colors: points.iter().map(|p| p.2).collect(),
            ..Cloud::default()
        };
        let first = distinct(&cloud(&points));
        assert_eq!(first.positions.len(), 400);
        assert!(first.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-6 || *n == Vec3::ZERO));
        let twice: Vec<_> = points.iter().rev().chain(&points).chain(&points[..77]).copied().collect();
        let second = distinct(&cloud(&twice));
        assert_eq!(first.positions, second.positions);
        assert_eq!(first.normals, second.normals);
        assert_eq!(first.colors, second.colors);
        for (point, &place) in twice.iter().zip(&second.place) {
            assert_eq!(point.0, second.positions[place as usize]);
        }
    }
}
