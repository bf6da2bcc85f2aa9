//! Corners of three lines moved to where the planes of the three faces around them meet.
//!
//! Near a corner the third face draws samples of a crease off it, and so what is carried on from these. The points of
//! each face tell its plane all the same.

use glam::{DMat3, DVec3};

use super::corners::SOLID;
use super::lines::Line;
use super::plane::{Moments, Plane};
use super::samples::{CUTOFF, Points, SIDE_POINTS, STRAY};

/// Points looked at around a corner: some four spacings on each face.
const LOOKED_AT: usize = 48;

/// Within this share of their size lines tell less of where they run than the corner does: with a half of it, clouds of
/// fandisk take 3 % more bytes, and where all places stay that lead to a corner that moves, edges are 2.3 bounds off.
const BESIDE: f64 = 1.0;

/// A point is of the face whose plane it is nearest to, by this share of the distance from the next one.
const NEARER: f64 = 0.5;

/// Times that points are told apart by planes and these fitted to them.
const ROUNDS: usize = 3;

/// A corner moves by less than this share of the size of its lines.
const MISS: f64 = 0.4;

/// An end of a line: its place, the number of the line, whether it is the last.
type Tip = ([u64; 3], usize, bool);

/// Moves the places where just three lines end, as far as the points around show three faces that meet.
pub(super) fn sharpen(lines: &mut [Line], points: &Points<'_>) {
    let mut tips: Vec<Tip> = Vec::new();
    for (n, line) in lines.iter().enumerate().filter(|(_, line)| !line.closed) {
        for (last, tip) in [(false, line.places.first()), (true, line.places.last())] {
            tips.extend(tip.map(|tip| (tip.to_array().map(f64::to_bits), n, last)));
        }
    }
    tips.sort_unstable();
    for of in tips.chunk_by(|a, b| a.0 == b.0) {
        if let &[a, b, c] = of
            && let Some(place) = corner(lines, [a, b, c], points)
        {
            of.iter().for_each(|&(_, n, last)| end_at(&mut lines[n], last, place));
        }
    }
}

/// Where the faces between three lines meet that end at one place.
fn corner(lines: &[Line], of: [Tip; 3], points: &Points<'_>) -> Option<DVec3> {
    let place = DVec3::from_array(of[0].0.map(f64::from_bits));
    let ways = of.map(|(_, n, last)| way(&lines[n], last));
    let size = of.iter().map(|&(_, n, _)| lines[n].size).fold(f64::INFINITY, f64::min);
    sharp(place, ways, points).filter(|sharp| sharp.distance(place) <= MISS * size)
}

/// Lets a line whose end moves end at a place, to which it goes straight on.
fn end_at(line: &mut Line, last: bool, place: DVec3) {
    let Line { places, size, .. } = line;
    if last {
        places.reverse();
    }
    let beside =
        places[1..places.len() - 1].iter().take_while(|other| other.distance(place) <= BESIDE * *size);
    let beside = beside.count();
    places.splice(..=beside, [place]);
    if last {
        places.reverse();
    }
}

/// Unit vector from an end of a line along it, to the first of its places that is not beside the end.
fn way(line: &Line, last: bool) -> DVec3 {
    let count = line.places.len();
    let from_end = |n: usize| line.places[if last { count - 1 - n } else { n }];
    let end = from_end(0);
    let far = (1..count).map(from_end).find(|place| place.distance(end) >= BESIDE * line.size);
    (far.unwrap_or_else(|| from_end(count - 1)) - end).normalize_or_zero()
}

/// Where the planes of the faces meet that lie between three ways from a place, unit vectors.
fn sharp(place: DVec3, ways: [DVec3; 3], points: &Points<'_>) -> Option<DVec3> {
    let spacing = points.laid.at(place);
    let around = points.laid.search.around(place.as_vec3(), LOOKED_AT);
    let around: Vec<DVec3> = around.into_iter().map(|n| (points.at(n) - place) / spacing).collect();
    // Planes are off by what lines miss at first, and points scatter besides.
    let within = CUTOFF + STRAY * points.noise / spacing;
    let between = |n: usize| {
        let normal = ways[n].cross(ways[(n + 1) % ways.len()]).normalize_or_zero();
        Plane { middle: DVec3::ZERO, normal, width: 0.0 }
    };
    let mut planes = [between(0), between(1), between(2)];
    for _ in 0..ROUNDS {
        let faces = faces(&around, &planes, within)?;
        planes = [faces[0].plane()?, faces[1].plane()?, faces[2].plane()?];
    }
    let normals = DMat3::from_cols_array_2d(&planes.map(|plane| plane.normal.to_array())).transpose();
    let heights = DVec3::from_array(planes.map(|plane| plane.middle.dot(plane.normal)));
    (normals.determinant().abs() > SOLID).then(|| place + spacing * (normals.inverse() * heights))
}

/// The points of each of three planes that are clearly of none of the others; `None` if one has too few.
fn faces(points: &[DVec3], planes: &[Plane; 3], within: f64) -> Option<[Moments; 3]> {
    let (mut faces, mut counts) = ([Moments::default(); 3], [0; 3]);
    for &p in points {
        let off = planes.map(|plane| (p - plane.middle).dot(plane.normal).abs());
        let mut order = [0, 1, 2];
        order.sort_by(|&a: &usize, &b| off[a].total_cmp(&off[b]));
        let [face, next, _] = order;
        if off[face] <= within && off[face] <= NEARER * off[next] {
            faces[face] = faces[face].with(p);
            counts[face] += 1;
        }
    }
    counts.into_iter().all(|count| count >= SIDE_POINTS).then_some(faces)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::analyse::planted::{lay, on_step, spaced};

    /// Edges of a step, whose corner is the origin, that go on to a place beside it.
    fn edges(corner: DVec3, size: f64) -> Vec<Line> {
        let edge = |axis: DVec3| {
            let places = (0..24).map(|n| (0.5 - 0.02 * f64::from(n)) * axis).chain([corner]);
            Line { places: places.collect(), closed: false, size }
        };
        DVec3::AXES.map(edge).to_vec()
    }

    #[test]
    fn corners_lie_where_their_faces_meet() {
        let positions: Vec<_> = (0..8000).map(|n| on_step(n).0.as_vec3()).collect();
        let (search, nearest, spacing) = lay(&positions);
        let points = Points { laid: spaced(&search, &positions, &spacing), nearest: &nearest, noise: 0.0 };
        let off = DVec3::new(0.004, -0.002, 0.003);
        let mut lines = edges(off, 0.05);
        // One more that ends elsewhere stays.
        lines.push(Line { places: vec![off + DVec3::X, DVec3::X], closed: false, size: 0.05 });
        let before = lines.clone();
        sharpen(&mut lines, &points);
        assert_eq!(lines[3], before[3]);
        for (line, before) in lines.iter().zip(&before[..3]) {
            let (end, rest) = line.places.split_last().unwrap();
            assert!(end.length() < 1e-6, "{end}");
            assert!(rest.iter().all(|place| place.distance(*end) > BESIDE * line.size));
            assert_eq!(rest, &before.places[..rest.len()]);
            assert!(before.places.len() > line.places.len());
        }
        // Farther off than lines miss corners, and where but two meet, nothing moves.
        let mut far = edges(6.0 * off, 0.05);
        let mut two = edges(off, 0.05)[..2].to_vec();
        let untouched = (far.clone(), two.clone());
        sharpen(&mut far, &points);
        sharpen(&mut two, &points);
        assert_eq!((far, two), untouched);
    }
}
