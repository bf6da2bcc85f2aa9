//! The normal of a point whose sheet another crosses: the plane through all of its neighbours is of no sheet there.
//!
//! Of the planes through the point and two of its neighbours, all of which are tried, it is the one near which the
//! others lie most (consensus: Fischler and Bolles 1981), fitted again to those. It counts only where they lie all
//! around the point, and the rest on another plane and on both sides: along a plane that ends at a fold, splats would
//! stand out beyond it.

use glam::{DVec2, DVec3, Vec3};

use super::cloud_creases::Points;
use super::cloud_graph::widest_gap;
use super::cloud_normals::{Plane, plane};
use super::nearest::listed;

/// Points that scatter across their plane by no more than this share of their variance along it are of one sheet:
/// those of an even sampling do if they scatter by a fifth of the spacing.
const ROUGH: f64 = 0.03;

/// Points looked at: where two sheets cross half of them are of either, enough to lie all around.
const LOOKED_AT: usize = 32;

/// Points are of a plane within this share of the distance of the farthest looked at: a fifth of the spacing.
const NEAR: f64 = 0.07;

/// A plane is known where the same share of the distance of a point's neighbours is at least so many standard
/// deviations of the noise.
const ABOVE_NOISE: f64 = 3.0;

/// Two points tell a plane if they are seen from the first at an angle with more than this sine (24°).
const APART: f64 = 0.4;

/// A plane near which fewer of those looked at lie is of no sheet but of a row of points along a fold, say.
const FEWEST: usize = 11;

/// Another sheet goes through a plane if at least so many points lie beyond it on either side: at a fold the surface
/// goes on to one.
const THROUGH: usize = 2;

/// The normal of a point's own sheet, of either sign, where `all`, the plane through all its neighbours, is of none
/// for another sheet crossing it; `None` elsewhere.
pub(super) fn normal(points: &Points<'_>, index: usize, all: &Plane) -> Option<Vec3> {
    let positions = points.laid.positions;
    let offset = |n: u32| (positions[n as usize] - positions[index]).as_dvec3();
    let neighbours = listed(&points.nearest[index]).map(|n| offset(n).length()).fold(0.0, f64::max);
    if all.roundness <= ROUGH || NEAR * neighbours < ABOVE_NOISE * points.noise {
        return None;
    }
    let mut others = points.laid.search.around(positions[index], LOOKED_AT + 1);
    others.retain(|&other| other as usize != index);
    let offsets: Vec<DVec3> = others.iter().map(|&n| offset(n)).collect();
    let near = NEAR * offsets.iter().map(|offset| offset.length()).fold(0.0, f64::max);
    let best = best(&offsets, near)?;
    let (held, rest): (Vec<u32>, Vec<u32>) = others.iter().partition(|&&n| offset(n).dot(best).abs() < near);
    let beyond = |side: f64| rest.iter().filter(|&&n| side * offset(n).dot(best) > 0.0).count();
    let of_plane = |points: &[u32]| plane(positions, points[0] as usize, points[1..].iter().copied());
    let crossed =
        [1.0, -1.0].map(beyond).iter().all(|&count| count >= THROUGH) && of_plane(&rest).roundness <= ROUGH;
    let sheet = || plane(positions, index, held.iter().copied()).normal;
    (crossed && goes_on(held.iter().map(|&n| offset(n)), best)).then(sheet)
}

/// Whether enough places near the plane through the origin with this unit normal lie all around that.
fn goes_on(held: impl Iterator<Item = DVec3>, normal: DVec3) -> bool {
    let (right, up) = normal.any_orthonormal_pair();
    let around: Vec<DVec2> = held.map(|offset| DVec2::new(offset.dot(right), offset.dot(up))).collect();
    around.len() >= FEWEST && widest_gap(&around).is_none()
}

/// The unit normal of the plane through the origin and two places near which most lie, the nearer the more; `None`
/// where no two tell one.
fn best(offsets: &[DVec3], near: f64) -> Option<DVec3> {
    let weight = |offset: &DVec3, normal: DVec3| {
        let off = offset.dot(normal) / near;
        (1.0 - off * off).max(0.0)
    };
    let pairs = offsets.iter().enumerate().flat_map(|(n, a)| offsets[..n].iter().map(move |b| (a, b)));
    let mut best = (0.0, None);
    for (a, b) in pairs {
        let across = a.cross(*b);
        if across.length() < APART * a.length() * b.length() {
            continue;
        }
        let Some(normal) = across.try_normalize() else { continue };
        let held: f64 = offsets.iter().map(|offset| weight(offset, normal)).sum();
        if held > best.0 {
            best = (held, Some(normal));
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::analyse::nearest::{Search, Spacings, spacing};
    use crate::analyse::planted::random;

    /// What points of a sheet lie apart.
    const SPACING: f64 = 0.02;

    /// A sheet of a surface along the x axis: from a number in `[-0.5, 0.5]` across to place and normal.
    type Sheet = dyn Fn(f64) -> [DVec3; 2];

    /// Of points strewn over two sheets, half a spacing to two from where these meet: of how many the plane through
    /// all neighbours, of how many the normal found has the direction of their sheet within 15°, of how many another
    /// is found, as shares.
    fn right(sheets: [&Sheet; 2]) -> [f64; 3] {
        let at = |n: u64| [0.5 * random(2 * n), 0.5 * random(2 * n + 1)];
        let sheet = |n: u64| sheets[(n % 2) as usize](at(n)[1]);
        let positions: Vec<Vec3> = (0..5000).map(|n| (at(n)[0] * DVec3::X + sheet(n)[0]).as_vec3()).collect();
        let search = Search::new(&positions).unwrap();
        let nearest = search.nearest();
        let spacing = spacing(&positions, &nearest);
        let laid = Spacings { search: &search, positions: &positions, spacing: &spacing };
        let points = Points { laid, nearest: &nearest, noise: 0.0 };
        let [mut before, mut after, mut changed, mut count] = [0.0; 4];
        for (n, row) in nearest.iter().enumerate() {
            let [x, across] = at(n as u64);
            if x.abs() < 0.45 && (0.5 * SPACING..2.0 * SPACING).contains(&across.abs()) {
                let all = plane(&positions, n, listed(row));
                let found = normal(&points, n, &all);
                let agrees = |normal: Vec3| normal.as_dvec3().dot(sheet(n as u64)[1]).abs() > 0.966;
                before += f64::from(u8::from(agrees(all.normal)));
                after += f64::from(u8::from(agrees(found.unwrap_or(all.normal))));
                changed += f64::from(u8::from(found.is_some()));
                count += 1.0;
            }
        }
        [before, after, changed].map(|sum| sum / count)
    }

    #[test]
    fn each_point_of_crossing_sheets_has_the_normal_of_its_own() {
        for (degrees, share) in [(40.0_f64, 0.75), (60.0, 0.85), (90.0, 0.95)] {
            let (sin, cos) = libm::sincos(degrees.to_radians());
            let level = |at: f64| [at * DVec3::Y, DVec3::Z];
            let steep = move |at: f64| [DVec3::new(0.0, at * cos, at * sin), DVec3::new(0.0, -sin, cos)];
            let [before, after, _] = right([&level, &steep]);
            assert!(before < 0.8 && after > share, "{degrees}: {before} {after}");
        }
    }

    #[test]
    fn at_a_fold_the_plane_through_all_stays() {
        for degrees in [60.0_f64, 90.0, 130.0] {
            let (sin, cos) = libm::sincos(degrees.to_radians());
            let fold = move |at: f64| match at < 0.0 {
                true => [at * DVec3::Y, DVec3::Z],
                false => [DVec3::new(0.0, at * cos, -at * sin), DVec3::new(0.0, sin, cos)],
            };
            let [.., changed] = right([&fold, &fold]);
            assert!(changed < 0.005, "{degrees}: {changed}");
        }
    }
}
