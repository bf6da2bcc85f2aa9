#![allow(clippy::unwrap_used)]

use std::f64::consts::PI;

use super::*;
use crate::analyse::canonical::mix;
use crate::analyse::nearest::listed;
use crate::analyse::planted::{lay, normal, random, side_by_side, spaced};

/// Points strewn over the faces of the cube `[-1, 1]³ / 2`, with their normals.
fn cube(each: u64) -> (Vec<Vec3>, Vec<Vec3>) {
    let value = |n: u64| (mix(n) >> 40) as f32 / (1 << 24) as f32 - 0.5;
    (0..6 * each)
        .map(|n| {
            let (axis, side) = ((n % 3) as usize, if n % 6 < 3 { 0.5 } else { -0.5 });
            let mut point = Vec3::new(value(3 * n), value(3 * n + 1), value(3 * n + 2));
            point[axis] = side;
            (point, 2.0 * side * Vec3::AXES[axis])
        })
        .unzip()
}

fn edges() -> Vec<Vec<DVec3>> {
    let corner = |n: usize| DVec3::new((n & 1) as f64, (n >> 1 & 1) as f64, (n >> 2) as f64) - 0.5;
    let ends = (0..8).flat_map(|n| [1, 2, 4].map(|bit| (n, n | bit)));
    ends.filter(|(a, b)| a != b).map(|(a, b)| vec![corner(a), corner(b)]).collect()
}

/// Points strewn over an L of height 1: the square `[-1, 1]²` without its quarter of positive coordinates.
fn ell(each: u64) -> (Vec<Vec3>, Vec<Vec3>) {
    let value = |n: u64| 0.5 + 0.5 * random(n) as f32;
    let squares = [(-1.0, -1.0), (0.0, -1.0), (-1.0, 0.0)];
    let levels = [(0.0, Vec3::NEG_Z), (1.0, Vec3::Z)];
    let ends =
        squares.iter().flat_map(|&(x, y)| levels.map(|(z, out)| (Vec3::new(x, y, z), Vec3::X, Vec3::Y, out)));
    let wall = |x: f32, y: f32, along: Vec3, out: Vec3| (Vec3::new(x, y, 0.0), along, Vec3::Z, out);
    let walls = [
        wall(-1.0, -1.0, Vec3::X, Vec3::NEG_Y),
        wall(0.0, -1.0, Vec3::X, Vec3::NEG_Y),
        wall(1.0, -1.0, Vec3::Y, Vec3::X),
        wall(0.0, 0.0, Vec3::X, Vec3::Y),
        wall(0.0, 0.0, Vec3::Y, Vec3::X),
        wall(-1.0, 1.0, Vec3::X, Vec3::Y),
        wall(-1.0, -1.0, Vec3::Y, Vec3::NEG_X),
        wall(-1.0, 0.0, Vec3::Y, Vec3::NEG_X),
    ];
    let faces: Vec<_> = ends.chain(walls).collect();
    (0..faces.len() as u64 * each)
        .map(|n| {
            let (corner, right, up, out) = faces[(n % faces.len() as u64) as usize];
            (corner + value(2 * n) * right + value(2 * n + 1) * up, out)
        })
        .unzip()
}

/// The edges of that, in pieces of all lengths up to `longest`; the one of the inner corner slants by its ends.
fn ell_edges(longest: f64) -> Vec<Vec<DVec3>> {
    let around = [(-1.0, -1.0), (1.0, -1.0), (1.0, 0.0), (0.0, 0.0), (0.0, 1.0), (-1.0, 1.0)];
    let at = |n: usize, z: f64| DVec3::new(around[n % 6].0, around[n % 6].1, z);
    let mut lines: Vec<Vec<DVec3>> = Vec::new();
    for n in 0..6 {
        let slant = if n == 3 { 0.05 * longest * DVec3::new(1.0, 1.0, 0.0) } else { DVec3::ZERO };
        let upright = [0.0, longest, 1.0 - longest, 1.0].map(|z| at(n, z));
        lines.push(vec![upright[0], upright[1] - slant, upright[2] - slant, upright[3]]);
        lines.extend([0.0, 1.0].map(|z| vec![at(n, z), at(n + 1, z)]));
    }
    lines.into_iter().map(|line| cut_up(&line, longest)).collect()
}

/// A line with more vertices between its own, up to `longest` apart.
fn cut_up(line: &[DVec3], longest: f64) -> Vec<DVec3> {
    let mut places = vec![line[0]];
    for (&to, n) in line[1..].iter().zip(0_u64..) {
        let from = places[places.len() - 1];
        let (mut way, length) = (0.0, from.distance(to));
        for k in 0.. {
            way += longest * (0.525 + 0.475 * random(100 * n + k));
            if way >= length {
                break;
            }
            places.push(from.lerp(to, way / length));
        }
        places.push(to);
    }
    places
}

#[test]
fn faces_are_parted_everywhere_along_their_edges() {
    let (positions, normals) = ell(2000);
    let (search, nearest, spacing) = lay(&positions);
    let sites = side_by_side(&positions, &normals, &nearest, &spacing);
    let apart = 1.0_f32 / 45.0;
    let cut =
        LineCut::new(Network::new(&ell_edges(apart.into()), &spaced(&search, &positions, &spacing)), &sites);
    for (segment, sheets) in (0_u32..).zip(&cut.sheets.of) {
        assert_eq!(sheets.len(), 2, "each edge is of two faces: {:?}", cut.network.ends(segment));
    }
    let mut needless = 0;
    for point in 0..positions.len() as u32 {
        for other in listed(&nearest[point as usize]) {
            let across = normals[point as usize] != normals[other as usize];
            let parted = cut.parts(&sites, point, other);
            let middle = positions[point as usize].midpoint(positions[other as usize]);
            // Through the solid at the inner corners, ways from face to face pass no edge.
            let inner = middle.truncate().length().max(middle.z.min(1.0 - middle.z)) < 2.0 * apart;
            assert!(parted || !across || inner, "{middle}: {point} is joined to {other} across an edge");
            needless += u32::from(parted && !across);
        }
    }
    // Ways past the end of a line that slants toward them.
    assert!(needless < 100, "{needless} pairs of one face are parted");
}

#[test]
fn the_faces_of_a_noisy_cube_are_told_apart() {
    let (exact, normals) = cube(1500);
    let noise = 0.6 / 1500_f64.sqrt();
    let stray = |n: u64| noise * normal(n);
    let strayed =
        |(n, at): (u64, &Vec3)| *at + DVec3::new(stray(3 * n), stray(3 * n + 1), stray(3 * n + 2)).as_vec3();
    let positions: Vec<Vec3> = (0..).zip(&exact).map(strayed).collect();
    let (search, nearest, spacing) = lay(&positions);
    let quiet = side_by_side(&positions, &normals, &nearest, &spacing);
    let network = Network::new(&edges(), &spaced(&search, &positions, &spacing));
    let whole = |sites: &Sites<'_>| {
        let of = LineCut::new(network.clone(), sites).sheets.of;
        of.iter().filter(|sheets| sheets.len() == 2).count() as f64 / of.len() as f64
    };
    let (told, untold) = (whole(&Sites { noise, ..quiet }), whole(&quiet));
    assert!(
        told > 0.99 && untold < 0.5,
        "{told} and, noise unknown, {untold} of the segments have two faces"
    );
}

#[test]
fn the_sides_of_a_noisy_groove_are_told_apart_by_a_line_below_it() {
    let step = 0.02;
    let (sin, cos) = libm::sincos(30_f64.to_radians());
    let (sites, normals): (Vec<Vec3>, Vec<Vec3>) = (0..5000_u64)
        .map(|n| {
            let (x, way) = (random(2 * n), 0.5 + 0.5 * random(2 * n + 1));
            let side = if n.is_multiple_of(2) { 1.0 } else { -1.0 };
            let off = DVec3::new(normal(3 * n), normal(3 * n + 1), normal(3 * n + 2));
            let place = DVec3::new(x, side * way * sin, way * cos) + 0.5 * step * off;
            (place.as_vec3(), DVec3::new(0.0, -side * cos, sin).as_vec3())
        })
        .unzip();
    let (search, nearest, spacing) = lay(&sites);
    let sites = Sites { noise: 0.5 * step, ..side_by_side(&sites, &normals, &nearest, &spacing) };
    let line = [DVec3::NEG_X, DVec3::X].map(|end| end - 0.6 * step * DVec3::Z);
    let network = Network::new(&[line.to_vec()], &spaced(&search, sites.positions, &spacing));
    let of = LineCut::new(network, &sites).sheets.of;
    let told = of.iter().filter(|sheets| sheets.len() == 2).count();
    assert!(told as f64 > 0.99 * of.len() as f64, "{told} of {}", of.len());
}

#[test]
fn the_walls_of_a_wedge_are_told_apart_as_far_as_it_is_thin() {
    let step = (4.0 / 20_000.0_f64).sqrt();
    let (sin, cos) = libm::sincos(18_f64.to_radians());
    let (sites, normals): (Vec<Vec3>, Vec<Vec3>) = (0..20_000_u64)
        .map(|n| {
            let (x, way) = (random(2 * n), 0.5 + 0.5 * random(2 * n + 1));
            let side = if n.is_multiple_of(2) { 1.0 } else { -1.0 };
            let place = DVec3::new(x, side * way * sin, way * cos);
            (place.as_vec3(), DVec3::new(0.0, side * cos, -sin).as_vec3())
        })
        .unzip();
    let (search, nearest, spacing) = lay(&sites);
    let sites = side_by_side(&sites, &normals, &nearest, &spacing);
    let line = [DVec3::NEG_X, DVec3::X];
    let network = Network::new(&[line.to_vec()], &spaced(&search, sites.positions, &spacing));
    let cut = LineCut::new(network, &sites);
    // Where both lie between three spacings and four from the line, its ends aside.
    let told = |n: u32| {
        let place = sites.positions[n as usize];
        place.x.abs() < 0.9 && (3.2 * step..4.0 * step).contains(&f64::from(place.with_x(0.0).length()))
    };
    let across = (0..sites.positions.len() as u32).filter(|&n| told(n)).flat_map(|n| {
        let others = listed(&nearest[n as usize]).map(move |other| (n, other));
        others.filter(|&(n, other)| told(other) && n % 2 != other % 2)
    });
    let across: Vec<(u32, u32)> = across.collect();
    let parted = across.iter().filter(|&&(a, b)| cut.parts(&sites, a, b)).count();
    assert!(across.len() > 50 && parted as f64 > 0.8 * across.len() as f64, "{parted} of {}", across.len());
}

#[test]
fn a_normal_of_several_faces_becomes_that_of_the_face() {
    let (positions, normals) = cube(1500);
    let (search, nearest, spacing) = lay(&positions);
    let sites = side_by_side(&positions, &normals, &nearest, &spacing);
    let cut = LineCut::new(Network::new(&edges(), &spaced(&search, &positions, &spacing)), &sites);
    let (mut beside, mut far, mut slight) = (0, 0, 0);
    for (point, own) in (0_u32..).zip(&normals) {
        let at = positions[point as usize];
        let is_mended = |by: f32| {
            let tilted = (*own + by * own.any_orthonormal_vector()).normalize();
            let mended = cut.mended(&sites, point, tilted);
            assert!(mended == tilted || mended.dot(*own) > 0.999, "{at}");
            mended != tilted
        };
        assert!(!is_mended(0.1), "{at} is nearly that of the face");
        slight += u32::from(is_mended(0.3));
        let is_beside = cut.border_beside(&sites, point).is_some();
        assert_eq!(is_mended(1.0), is_beside, "{at}");
        beside += u32::from(is_beside);
        far += u32::from(!is_beside);
    }
    // Few have as many neighbours in a plane between two faces.
    assert!(f64::from(slight) > 0.95 * f64::from(beside), "{slight} of {beside}");
    assert!(beside > 500 && far > 5000, "{beside} {far}");
}

#[test]
fn a_cube_falls_into_six_loops() {
    let (positions, normals) = cube(1500);
    let (search, nearest, spacing) = lay(&positions);
    let sites = side_by_side(&positions, &normals, &nearest, &spacing);
    let network = Network::new(&edges(), &spaced(&search, &positions, &spacing));
    let (nodes, segments) = (network.nodes.len(), network.segments.len());
    assert_eq!(segments, nodes - 8 + 12, "twelve lines of one segment more than inner nodes");
    let cut = LineCut::new(network, &sites);
    for border in &cut.borders {
        let sheet = cut.sheet(border);
        let [a, b] = border.points.map(|point| cut.points[point as usize].position.as_dvec3());
        assert!((sheet.normal.dot(a) - 0.5).abs() < 1e-6, "the sheet's outside: {sheet:?}");
        let left = sheet.normal.cross(b - a).normalize();
        assert!(left.distance(sheet.inward) < 1e-6 && left.dot(-0.5 * (a + b)) > 0.4);
    }
    // As many borders end at a point as begin there: one.
    let mut ends: Vec<(u32, u32)> = cut.sides().collect();
    ends.sort_unstable();
    assert!(ends.iter().enumerate().all(|(n, end)| end.0 == n as u32));
    ends.sort_unstable_by_key(|end| end.1);
    assert!(ends.iter().enumerate().all(|(n, end)| end.1 == n as u32));
    assert_eq!(cut.points.len(), 2 * (nodes - 8) + 24);
}

#[test]
fn a_sheet_that_shows_on_both_sides_of_a_short_gap_goes_on_through_it_and_round_a_corner() {
    let (positions, normals) = cube(1500);
    let (search, nearest, spacing) = lay(&positions);
    let sites = side_by_side(&positions, &normals, &nearest, &spacing);
    let network = Network::new(&edges(), &spaced(&search, &positions, &spacing));
    let whole = LineCut::new(network.clone(), &sites);
    let corner = DVec3::splat(0.5);
    // The sheet of the upper face, along its edges that meet at a corner.
    let is_of = |segment: u32, sheet: &Sheet| {
        sheet.normal.z > 0.9 && network.ends(segment).iter().all(|end| end.z > 0.4)
    };
    let lacking = |reach: f64, on: &dyn Fn(u32) -> bool| {
        let mut sheets = whole.sheets.clone();
        let near = (0..network.segments.len() as u32)
            .filter(|&n| network.ends(n).iter().all(|end| end.distance(corner) < reach));
        let near: Vec<u32> =
            near.filter(|&n| on(n) && sheets.of[n as usize].iter().any(|sheet| is_of(n, sheet))).collect();
        near.iter().for_each(|&n| sheets.of[n as usize].retain(|sheet| !is_of(n, sheet)));
        (near, LineCut::of(network.clone(), sheets))
    };
    let fills = |near: &[u32], cut: LineCut| {
        let gaps = cut.gaps(&sites);
        for (segment, sheet) in &gaps {
            let own = whole.sheets.of[*segment as usize].iter().find(|own| is_of(*segment, own)).unwrap();
            assert!(
                own.inward.dot(sheet.inward) > 0.999 && own.normal.dot(sheet.normal) > 0.999,
                "{sheet:?}"
            );
            assert!(
                sheet.points.iter().all(|&point| positions[point as usize].z > 0.499),
                "its points lie on it"
            );
        }
        let mut filled: Vec<u32> = gaps.iter().map(|gap| gap.0).collect();
        filled.sort_unstable();
        assert_eq!(filled, near);
        let mended = cut.with(gaps);
        assert_eq!(mended.loose(), Default::default());
        assert_eq!(mended.points.len(), whole.points.len());
    };
    // On one edge alone, from the corner on, and on both.
    let one = lacking(0.12, &|segment| network.along(segment).x.abs() > 0.9);
    let both = lacking(0.06, &|_| true);
    assert!((3..=8).contains(&one.0.len()) && (3..=8).contains(&both.0.len()), "{one:?} {both:?}");
    fills(&one.0, one.1);
    fills(&both.0, both.1);
    // A gap longer than points along a line may be lacking is one of the surface.
    assert!(lacking(0.6, &|_| true).1.gaps(&sites).is_empty());
}

#[test]
fn the_other_side_of_a_thin_wall_is_no_sheet_of_a_line() {
    // Along x an inner edge of two walls, three spacings thick, and their outer sides with a rounded edge; points lie
    // about 0.02 apart.
    let thick = 0.06;
    let place = |n: u64| {
        let (x, way) = (random(2 * n), 0.3 * random(2 * n + 1));
        if n.is_multiple_of(2) {
            let inner = if way < 0.0 { DVec3::new(x, -way, 0.0) } else { DVec3::new(x, 0.0, way) };
            return (inner, if way < 0.0 { DVec3::Z } else { DVec3::Y });
        }
        let angle = (way / thick).clamp(-0.25 * PI, 0.25 * PI);
        let (sin, cos) = libm::sincos(1.25 * PI - angle);
        let beyond = (way.abs() - 0.25 * PI * thick).max(0.0);
        let on = if way < 0.0 { DVec3::Y } else { DVec3::Z };
        let out = DVec3::new(0.0, cos, sin);
        (x * DVec3::X + thick * out + beyond * on, out)
    };
    let (positions, normals): (Vec<Vec3>, Vec<Vec3>) = (0..6000)
        .map(|n| {
            let (place, normal) = place(n);
            (place.as_vec3(), normal.as_vec3())
        })
        .unzip();
    let (search, nearest, spacing) = lay(&positions);
    let lines = [vec![-0.9 * DVec3::X, 0.9 * DVec3::X]];
    let network = Network::new(&lines, &spaced(&search, &positions, &spacing));
    let sites = side_by_side(&positions, &normals, &nearest, &spacing);
    let cut = LineCut::new(network, &sites);
    assert!(cut.sheets.of.len() > 20);
    for sheets in &cut.sheets.of {
        let inward: Vec<DVec3> = sheets.iter().map(|sheet| sheet.inward).collect();
        assert_eq!(inward.len(), 2, "{inward:?}");
        assert!(inward.iter().all(|way| way.y.max(way.z) > 0.95), "{inward:?}");
    }
    let outer = (0..positions.len()).filter(|&n| n % 2 == 1 && positions[n].x.abs() < 0.85);
    let outer = outer.filter(|&n| cut.is_beside(n as u32));
    // To a few points from which all others lie far the wall is thinner.
    let beside = outer.count();
    assert!(beside < 40, "{beside}");
}
