#![allow(clippy::unwrap_used)]

use std::f64::consts::PI;

use glam::{DVec3, Vec3};

use super::*;
use crate::analyse::planted::{lay, normal, random, spaced};
use crate::analyse::segment_grid::SegmentGrid;

/// A place that strays by `scatter` in every direction.
fn strayed(place: DVec3, scatter: f64, n: u64) -> Vec3 {
    (place + scatter * DVec3::new(normal(3 * n), normal(3 * n + 1), normal(3 * n + 2))).as_vec3()
}

fn cloud(positions: Vec<Vec3>) -> Cloud {
    Cloud { positions, ..Cloud::default() }
}

/// Points strewn over the faces of the cube `[-1, 1]³ / 2`: one for about 1/24² of a face.
fn cube(scatter: f64) -> Vec<Vec3> {
    let place = |n: u64| {
        let mut place = 0.5 * DVec3::new(random(3 * n), random(3 * n + 1), random(3 * n + 2));
        place[(n % 3) as usize] = if n % 6 < 3 { 0.5 } else { -0.5 };
        place
    };
    (0..6 * 576).map(|n| strayed(place(n), scatter, n)).collect()
}

/// The mean distance of the cube's points.
const SPACING: f64 = 1.0 / 24.0;

fn cube_edges() -> Vec<Vec<DVec3>> {
    let corner = |n: usize| DVec3::new((n & 1) as f64, (n >> 1 & 1) as f64, (n >> 2) as f64) - 0.5;
    let ends = (0..8).flat_map(|n| [1, 2, 4].map(|bit| (n, n | bit)));
    ends.filter(|(a, b)| a != b).map(|(a, b)| vec![corner(a), corner(b)]).collect()
}

/// Points of a cylinder of radius 0.4 and height 0.8 with flat ends, `each` on either end, strewn.
fn cylinder(each: u64) -> Vec<Vec3> {
    let place = |n: u64| {
        let (sin, cos) = libm::sincos(PI * random(2 * n));
        let (side, height) = (0.4 * DVec3::new(cos, sin, 0.0), 0.4 * random(2 * n + 1));
        match n % 6 {
            0 | 1 => {
                (0.5 + 0.5 * random(2 * n + 1)).sqrt() * side
                    + if n.is_multiple_of(6) { 0.4 } else { -0.4 } * DVec3::Z
            }
            _ => side + height * DVec3::Z,
        }
    };
    (0..6 * each).map(|n| place(n).as_vec3()).collect()
}

/// Points of the plate `[-1, 1]² × [-0.2, 0]` with a hole of this radius through it, strewn; they lie about 0.021 apart.
fn plate(radius: f64) -> Vec<Vec3> {
    let faces = (0..18_000_u64).filter_map(|n| {
        let place =
            DVec3::new(random(2 * n), random(2 * n + 1), if n.is_multiple_of(2) { 0.0 } else { -0.2 });
        (place.truncate().length() > radius).then_some(place)
    });
    let wall = (0..(0.4 * PI * radius * 2250.0) as u64).map(|n| {
        let (sin, cos) = libm::sincos(PI * random(2 * n));
        DVec3::new(radius * cos, radius * sin, 0.1 * (random(2 * n + 1) - 1.0))
    });
    faces.chain(wall).map(|place| place.as_vec3()).collect()
}

/// Points of the two sides of a step, `[-1, 1] × [-1, 0] × 0` below and `[-1, 1] × [0, 1] × high` above, and of the
/// wall between, which at `x > 0` stands back by `high`: they lie about 0.025 apart.
fn stepped(high: f64) -> Vec<Vec3> {
    let at = |x: f64| if x > 0.0 { high } else { 0.0 };
    let floors = (0..6400_u64).map(|n| {
        let (x, y) = (random(2 * n), random(2 * n + 1));
        DVec3::new(x, y, if y < at(x) { 0.0 } else { high })
    });
    let count = |area: f64| (1600.0 * area) as u64;
    let up = move |n: u64| 0.5 * high * (1.0 + random(2 * n + 1));
    let walls = (0..count(2.0 * high)).map(move |n| DVec3::new(random(2 * n), at(random(2 * n)), up(n)));
    let side =
        (0..count(high * high)).map(move |n| DVec3::new(0.0, 0.5 * high * (1.0 + random(2 * n)), up(n)));
    floors.chain(walls).chain(side).map(|place| place.as_vec3()).collect()
}

/// Points of a sphere of radius 0.8, strewn evenly.
fn sphere(count: u64, scatter: f64) -> Vec<Vec3> {
    let place = |n: u64| {
        let z = random(2 * n);
        let (sin, cos) = libm::sincos(PI * random(2 * n + 1));
        let across = libm::sqrt(1.0 - z * z);
        0.8 * DVec3::new(across * cos, across * sin, z)
    };
    (0..count).map(|n| strayed(place(n), scatter, n)).collect()
}

/// Two half planes that meet along the x axis, the second turned down by an angle.
fn roof(degrees: f64) -> Vec<Vec3> {
    let (sin, cos) = libm::sincos(degrees.to_radians());
    let place = |n: u64| {
        let (x, y) = (0.7 * random(2 * n), 0.7 * random(2 * n + 1));
        DVec3::new(x, if y > 0.0 { y * cos } else { y }, if y > 0.0 { -y * sin } else { 0.0 })
    };
    (0..3000).map(|n| place(n).as_vec3()).collect()
}

fn creases(positions: Vec<Vec3>, noise: f64) -> Vec<Vec<DVec3>> {
    cloud_creases(&cloud(positions), &Sought { degrees: 40.0, shortest: 0.02 }, Some(noise)).unwrap()
}

/// Distances of places on some lines from others, evenly along each segment.
fn distances(lines: &[Vec<DVec3>], others: &[Vec<DVec3>]) -> Vec<f64> {
    let segments = |lines: &[Vec<DVec3>]| -> Vec<[DVec3; 2]> {
        lines.iter().flat_map(|line| line.windows(2)).map(|pair| [pair[0], pair[1]]).collect()
    };
    let grid = SegmentGrid::new(segments(others));
    let places =
        segments(lines).into_iter().flat_map(|[a, b]| (0..=100).map(move |n| a.lerp(b, 0.01 * f64::from(n))));
    places.map(|place| grid.nearest(place, 4.0).map_or(f64::INFINITY, |near| near.distance)).collect()
}

/// The greatest distance of places on some lines from others.
fn apart(lines: &[Vec<DVec3>], others: &[Vec<DVec3>]) -> f64 {
    distances(lines, others).into_iter().fold(0.0, f64::max)
}

/// The length of some lines together.
fn length(lines: &[Vec<DVec3>]) -> f64 {
    lines.iter().flat_map(|line| line.windows(2)).map(|side| side[0].distance(side[1])).sum()
}

#[test]
fn the_edges_of_a_cube_are_found_and_nothing_else() {
    for (scatter, off) in [(0.0, 0.3), (0.2, 1.0)] {
        let found = creases(cube(scatter * SPACING), scatter * SPACING);
        assert!(apart(&found, &cube_edges()) < off * SPACING, "{scatter}: {}", apart(&found, &cube_edges()));
        let places = distances(&cube_edges(), &found);
        let near = places.iter().filter(|&&away| away < off * SPACING).count();
        assert!(near as f64 > 0.95 * places.len() as f64, "{scatter}: {near} of {}", places.len());
    }
}

#[test]
fn a_cylinder_has_two_circles() {
    let found = creases(cylinder(2000), 0.0);
    for place in found.iter().flatten() {
        let off = (place.truncate().length() - 0.4).hypot(place.z.abs() - 0.4);
        assert!(off < 0.007, "{place}: {off}");
    }
    let length = length(&found);
    assert!((length / (1.6 * PI) - 1.0).abs() < 0.05, "{length}");
}

#[test]
fn the_rims_of_a_hole_as_narrow_as_seven_spacings_are_found_whole() {
    for radius in [0.15, 0.2, 0.3] {
        let mut found = creases(plate(radius), 0.0);
        found.retain(|line| line[0].truncate().length() < 0.5);
        for place in found.iter().flatten() {
            let off = (place.truncate().length() - radius).hypot((place.z + 0.1).abs() - 0.1);
            assert!(off < 0.007, "{radius}: {place} is {off} off, and a spacing 0.021");
        }
        let length = length(&found);
        assert!((length / (4.0 * PI * radius) - 1.0).abs() < 0.03, "{radius}: {length}");
    }
}

#[test]
fn an_edge_too_short_for_samples_of_its_own_is_found_between_its_corners() {
    // Ten spacings, of which the third faces at both ends leave four.
    let found = creases(stepped(0.25), 0.0);
    for (x, y, along) in [(0.0, 0.0, DVec3::Z), (0.0, 0.25, DVec3::Z), (0.0, 0.0, DVec3::Y)] {
        let from = DVec3::new(x, y, 0.0);
        let edge = [vec![from, from + 0.25 * along]];
        assert!(apart(&edge, &found) < 0.02, "{along} from {from}: {}", apart(&edge, &found));
    }
}

/// Points of the end of a wall three spacings thick, and of its two sides; they lie about 0.02 apart.
fn thin_wall() -> Vec<Vec3> {
    let place = |n: u64| {
        let (x, way) = (random(2 * n), 0.2 * random(2 * n + 1));
        let beyond = way.abs() - 0.03;
        DVec3::new(x, if beyond < 0.0 { way } else { 0.03_f64.copysign(way) }, -beyond.max(0.0))
    };
    (0..2000).map(|n| place(n).as_vec3()).collect()
}

#[test]
fn the_edges_of_a_thin_wall_are_found() {
    let found = creases(thin_wall(), 0.0);
    let edges: Vec<Vec<DVec3>> =
        [-0.03, 0.03].map(|y| vec![DVec3::new(-0.85, y, 0.0), DVec3::new(0.85, y, 0.0)]).to_vec();
    assert!(apart(&edges, &found) < 0.015, "{}", apart(&edges, &found));
    let off = |place: &DVec3| (place.y.abs() - 0.03).hypot(place.z);
    assert!(found.iter().flatten().all(|place| off(place) < 0.005));
}

/// Points of a disc of this radius and height about its middle, strewn; they lie about 1 apart.
fn disc(radius: f64, height: f64) -> Vec<Vec3> {
    let area = 2.0 * PI * radius * (radius + height);
    let place = |n: u64| {
        let (sin, cos) = libm::sincos(PI * random(3 * n));
        let (side, up) = (radius * DVec3::new(cos, sin, 0.0), 0.5 * height * DVec3::Z);
        let (face, way) = (random(3 * n + 1) * (radius + height), random(3 * n + 2));
        match face.abs() < height {
            true => side + way * up,
            false => libm::sqrt(0.5 + 0.5 * way) * side + up * face.signum(),
        }
    };
    (0..area as u64).map(|n| place(n).as_vec3()).collect()
}

#[test]
fn the_rims_of_a_thin_disc_are_found_whole() {
    for radius in [15.0, 20.0, 30.0] {
        let found = creases(disc(radius, 3.0), 0.0);
        for place in found.iter().flatten() {
            let off = (place.truncate().length() - radius).hypot(place.z.abs() - 1.5);
            assert!(off < 0.5, "{radius}: {place} is {off} off");
        }
        let length = length(&found);
        assert!((length / (4.0 * PI * radius) - 1.0).abs() < 0.03, "{radius}: {length}");
    }
}

#[test]
fn gaps_of_lines_are_closed_where_points_show_the_crease_there() {
    let rim = cylinder(2000).into_iter().map(|p| p - Vec3::new(0.0, 0.4, 0.4)).collect();
    for (positions, place) in [
        (roof(90.0), (|at: f64| at * DVec3::X) as fn(f64) -> DVec3),
        (rim, |at: f64| 0.4 * DVec3::new(libm::sin(at / 0.4), libm::cos(at / 0.4) - 1.0, 0.0)),
    ] {
        let (search, nearest, spacing) = lay(&positions);
        let points = Points { laid: spaced(&search, &positions, &spacing), nearest: &nearest, noise: 0.0 };
        let size = 3.2 * points.usual_spacing();
        let piece = |from: f64, to: f64| Line {
            places: (0..=10).map(|n| place(from + 0.1 * (to - from) * f64::from(n))).collect(),
            closed: false,
            size,
        };
        let half = 1.5 * size;
        let lines = [piece(-3.0 * size, -half), piece(half, 3.0 * size)];
        let found = arms::between_ends(&lines, &points, libm::cos(40_f64.to_radians())).unwrap();
        assert_eq!(found.len(), 1, "{found:?}");
        let gap = [(0..=20).map(|n| place(half * (0.1 * f64::from(n) - 1.0))).collect()];
        let found = [found[0].clone().whole()];
        assert!(apart(&gap, &found) < 0.1 * size, "{} of {size}", apart(&gap, &found));
    }
}

/// Points of a square with a crest of 62° along the x axis, sharp up to `half` from its middle and ever rounder beyond;
/// they lie 0.018 apart and scatter by so much.
fn crest(half: f64, scatter: f64) -> Vec<Vec3> {
    let place = |n: u64| {
        let (x, y) = (0.7 * random(2 * n), 0.7 * random(2 * n + 1));
        DVec3::new(x, y, -0.6 * y.hypot(4.0 * (x.abs() - half).max(0.0).powi(2)))
    };
    (0..6000).map(|n| strayed(place(n), scatter, n)).collect()
}

#[test]
fn short_creases_that_end_in_the_midst_are_found_where_chance_makes_none() {
    let axis = [vec![0.24 * DVec3::X, -0.24 * DVec3::X]];
    for scatter in [0.0, 0.0018] {
        let found = creases(crest(0.08, scatter), scatter);
        assert_eq!(found.len(), 1, "{scatter}: {found:?}");
        assert!(apart(&found, &axis) < 0.009, "{scatter}: {}", apart(&found, &axis));
    }
    // As long beside the neighbourhoods that more noise calls for.
    assert_eq!(creases(crest(0.2, 0.009), 0.009), Vec::<Vec<DVec3>>::new());
}

#[test]
fn smooth_surfaces_have_no_creases() {
    assert_eq!(creases(sphere(4000, 0.0), 0.0), Vec::<Vec<DVec3>>::new());
    // Points lie 0.045 apart.
    for scatter in [0.005, 0.02] {
        assert_eq!(creases(sphere(4000, scatter), scatter), Vec::<Vec<DVec3>>::new());
    }
    // Hardly more than its radius apart.
    assert_eq!(creases(sphere(60, 0.0), 0.0), Vec::<Vec<DVec3>>::new());
    let solid = (0..3000).map(|n| DVec3::new(random(3 * n), random(3 * n + 1), random(3 * n + 2)).as_vec3());
    assert_eq!(creases(solid.collect(), 0.0), Vec::<Vec<DVec3>>::new());
}

#[test]
fn the_angle_decides() {
    for (degrees, lines) in [(25.0, 0), (55.0, 1), (90.0, 1), (140.0, 1)] {
        let found = creases(roof(degrees), 0.0);
        assert_eq!(found.is_empty(), lines == 0, "{degrees}: {found:?}");
        let axis = [vec![DVec3::X, -DVec3::X]];
        assert!(apart(&found, &axis) < 0.01, "{degrees}: {}", apart(&found, &axis));
    }
}

/// A floor and a wall that meet along the x axis, with a fillet of this radius; points lie 0.02 apart and
/// scatter by half of that.
fn corner(radius: f64) -> Vec<Vec3> {
    let arc = std::f64::consts::FRAC_PI_2 * radius;
    let place = |n: u64| {
        let (x, way) = (random(2 * n), random(2 * n + 1));
        let angle = (way / radius.max(f64::EPSILON)).clamp(-0.25 * PI, 0.25 * PI);
        let (sin, cos) = libm::sincos(angle);
        let beyond = (way.abs() - 0.5 * arc).max(0.0).copysign(way);
        let [y, z] = [radius * sin + beyond * cos, radius * (1.0 - cos) + beyond * sin];
        DVec3::new(x, y, z)
    };
    (0..10_000).map(|n| strayed(place(n), 0.01, n)).collect()
}

#[test]
fn a_bend_that_shows_in_the_noise_is_no_crease() {
    let axis = [vec![DVec3::X, -DVec3::X]];
    let sharp = creases(corner(0.0), 0.01);
    assert!(apart(&axis, &sharp) < 0.1, "{}", apart(&axis, &sharp));
    // Nor is the line drawn out of the edge by the points that count for the other side.
    let depths: Vec<f64> = sharp.iter().flatten().map(|place| place.z).collect();
    let depth = depths.iter().sum::<f64>() / depths.len() as f64;
    assert!(
        apart(&sharp, &axis) < 0.02 && depth.abs() < 0.003,
        "{}, {depth} on the mean",
        apart(&sharp, &axis)
    );
    for radius in [0.06, 0.08, 0.12] {
        assert_eq!(creases(corner(radius), 0.01), Vec::<Vec<DVec3>>::new(), "{radius}");
    }
}

#[test]
fn neither_the_order_of_points_nor_repeated_ones_matter() {
    let points = cube(0.01);
    let found = creases(points.clone(), 0.01);
    assert!(!found.is_empty());
    let turned: Vec<Vec3> = points.iter().rev().chain(&points[..100]).copied().collect();
    assert_eq!(creases(turned, 0.01), found);
}

#[test]
fn clouds_of_few_points_have_none() {
    for count in [0, 1, 2, 5, 20] {
        assert!(creases(cube(0.0)[..count].to_vec(), 0.0).is_empty());
    }
    let line = (0..100).map(|n| Vec3::X * (n as f32 / 100.0)).collect();
    assert!(creases(line, 0.0).is_empty());
}

#[test]
fn lines_that_go_on_over_gaps_are_long_as_one() {
    // Three pieces of two sizes each in a row, the outer ends of which meet nothing.
    let piece = |from: f64| Line {
        places: (0..=6).map(|n| DVec3::new(from + f64::from(n) / 3.0, 0.0, 0.0)).collect(),
        closed: false,
        size: 1.0,
    };
    let lines = || vec![piece(0.0), piece(2.5), piece(5.0)];
    let met = vec![[false, true], [true, true], [true, false]];
    let kept = |run: [u32; 3]| {
        worth_it(lines(), &Joined { met: met.clone(), run: run.to_vec() }, 0.0, LENGTHS).len()
    };
    assert_eq!([kept([0, 0, 0]), kept([0, 1, 2])], [3, 1]);
}
