//! Clouds cut along lines, given or found.

use glam::DVec3;
use qsplat::bake::{Edges, MaxError, Options};
use qsplat::model::polyline::Polylines;

use super::scene::{Draw, bake, bare, cloud, options, surface};

/// Points strewn over the faces of the cube `[-1, 1]³`, and their faces' normals.
fn cube(each: usize) -> (Vec<DVec3>, Vec<DVec3>) {
    let mut draw = Draw(21);
    (0..6 * each)
        .map(|n| {
            let (axis, side) = (n % 3, if n % 6 < 3 { 1.0 } else { -1.0 });
            let mut place = DVec3::new(draw.both(), draw.both(), draw.both());
            place[axis] = side;
            (place, side * DVec3::AXES[axis])
        })
        .unzip()
}

fn edges() -> Polylines {
    let corner = |n: usize| DVec3::new((n & 1) as f64, (n >> 1 & 1) as f64, (n >> 2) as f64) * 2.0 - 1.0;
    let ends = (0..8).flat_map(|n| [1, 2, 4].map(|bit| (n, n | bit)));
    Polylines { lines: ends.filter(|(a, b)| a != b).map(|(a, b)| vec![corner(a), corner(b)]).collect() }
}

#[test]
fn a_cube_has_sharp_edges() {
    let (places, normals) = cube(1500);
    let cloud = cloud(&places, &normals);
    let options = Options { edges: Edges::Given(edges()), ..options(MaxError::Relative(1e-3)) };
    let made = bake(&cloud, &options);
    let bound = made.asset.max_error * cloud.frame.scale();
    for place in made.asset.splats.iter().flat_map(surface) {
        let p = cloud.frame.to_input(place);
        assert!(p.abs().max_element() < 1.0 + 1.05 * bound, "{p} sticks out of the cube");
    }
    assert!(made.asset.splats.iter().all(|splat| !splat.clips.is_empty()));
    assert!(made.asset.splats.len() <= 24, "{}", made.asset.splats.len());
    // Every place of the faces is there, right up to the edges and corners.
    let dense: Vec<_> = (0..61 * 61)
        .map(|n| DVec3::new(f64::from(n % 61) / 30.0 - 1.0, f64::from(n / 61) / 30.0 - 1.0, 1.0))
        .map(|place| cloud.frame.to_model(place).as_vec3())
        .collect();
    assert_eq!(bare(&made, &dense, 2.0 * made.asset.max_error), 0);
}

#[test]
fn the_edges_that_a_cube_has_are_found() {
    let (places, normals) = cube(1500);
    let cloud = cloud(&places, &normals);
    let [found, none] = [Edges::Auto, Edges::None]
        .map(|edges| bake(&cloud, &Options { edges, ..options(MaxError::Relative(1e-3)) }).asset.splats);
    assert!(none.iter().all(|splat| splat.clips.is_empty()));
    // Six faces, and what lies beside corners and gaps in the lines.
    assert!(none.len() > 2 * found.len(), "{} and {}", found.len(), none.len());
}

#[test]
fn hostile_lines_do_no_harm() {
    let (places, normals) = cube(400);
    let mut draw = Draw(22);
    let mut place = |size: f64| DVec3::new(draw.both(), draw.both(), draw.both()) * size;
    let mut lines = vec![
        // Far off, of no length, there and back, a dart on a face, across a face and beyond.
        vec![DVec3::splat(40.0), DVec3::splat(50.0)],
        vec![DVec3::ONE, DVec3::ONE],
        vec![DVec3::new(-1.0, 0.2, 1.0), DVec3::new(1.0, 0.2, 1.0), DVec3::new(-1.0, 0.2, 1.0)],
        vec![DVec3::new(0.0, 0.0, 1.0), DVec3::new(0.3, 0.1, 1.0)],
        vec![DVec3::new(-1e9, 0.0, -1.0), DVec3::new(1e9, 1e-3, -1.0)],
    ];
    // Noise along an edge, and segments strewn through the inside and the faces.
    lines.push((0..200).map(|n| DVec3::new(f64::from(n) / 100.0 - 1.0, 1.0, 1.0) + place(0.02)).collect());
    lines.extend((0..100).map(|_| vec![place(1.2), place(1.2)]));
    let options = Options { edges: Edges::Given(Polylines { lines }), ..options(MaxError::Relative(5e-3)) };
    let made = bake(&cloud(&places, &normals), &options);
    assert!(made.asset.fit.max <= made.asset.max_error);
}
