//! What is measured against a cloud: nothing where nothing is wrong, and each fault that is there.

use glam::{DVec2, DVec3};
use qsplat::bake::{MaxError, Silent, kept, meant};
use qsplat::deliver::{self, Delivery, deliver};
use qsplat::ingest::Input;
use qsplat::measure::measures::Measures;
use qsplat::measure::{Reference, Subject, measure};
use qsplat::model::asset::Asset;

use super::scene::{Draw, cloud, options};

/// Places on a torus, evenly random.
fn torus(count: usize) -> Vec<DVec3> {
    let mut draw = Draw(21);
    let mut places = Vec::new();
    while places.len() < count {
        let (around, across) = (draw.one() * std::f64::consts::TAU, draw.one() * std::f64::consts::TAU);
        let ring = 1.0 + 0.4 * across.cos();
        if 1.4 * draw.one() < ring {
            places.push(DVec3::new(ring * around.cos(), ring * around.sin(), 0.4 * across.sin()));
        }
    }
    places
}

fn input(places: &[DVec3]) -> Input {
    Input::Cloud(cloud(places, &[]))
}

fn baked(input: &Input) -> Delivery {
    deliver(input, &options(MaxError::Relative(1e-3)), &mut Silent).unwrap()
}

/// What is measured of an asset against a cloud; `made` is what it comes from.
fn measured(asset: &Asset, made: &Delivery, input: &Input) -> Measures {
    let (options, max_error) = (options(MaxError::Relative(1e-3)), asset.max_error);
    let meant = meant(input, &options, max_error).unwrap();
    let kept = kept(&meant.input, &meant.edges, meant.noise, &options, max_error).unwrap();
    let reference = Reference::standing_for(deliver::surface(&kept), asset.diagonal).unwrap();
    measure(&Subject { bytes: &made.bytes, asset, against: &reference, lines: None }).unwrap()
}

/// A torus of random points, and what a bake makes of it.
fn scene() -> (Vec<DVec3>, Input, Delivery) {
    let places = torus(30_000);
    let input = input(&places);
    let made = baked(&input);
    (places, input, made)
}

/// The largest of an asset's splats.
fn largest(asset: &Asset) -> usize {
    let area = |n: &usize| asset.splats[*n].radii.x * asset.splats[*n].radii.y;
    (0..asset.splats.len()).max_by(|a, b| area(a).total_cmp(&area(b))).unwrap()
}

#[test]
fn nothing_is_counted_where_nothing_is_wrong() {
    let (_, input, made) = scene();
    let found = measured(&made.asset, &made, &input);
    println!("sound: {:?}, backward {:?} of {}", found.holes, found.backward, found.budget);
    // A disc whose normal is a little off may stand out by a pixel somewhere.
    let faults = found.holes.missing + found.holes.through;
    assert!(faults <= 16 && found.holes.extra == 0, "{:?}", found.holes);
    assert!(found.backward.max <= 2.0 * found.budget, "{:?}", found.backward);
    let all = 26.0 * 512.0 * 512.0;
    assert!(found.holes.pixels as f64 > 0.97 * all, "hardly any go uncompared: {:?}", found.holes);
}

#[test]
fn what_is_gone_is_missing_or_seen_through() {
    let (_, input, mut made) = scene();
    // On the outline of the torus seen along its axis.
    let gone = DVec3::new(1.4, 0.0, 0.0);
    let frame = made.asset.frame;
    made.asset.splats.retain(|splat| frame.to_input(splat.center).distance(gone) > 0.4);
    let found = measured(&made.asset, &made, &input).holes;
    println!("without some splats: {found:?}");
    assert!(found.missing > 100 && found.through > 1000 && found.extra == 0, "{found:?}");
}

#[test]
fn a_splat_that_stands_out_is_extra_and_far_backward() {
    let (_, input, mut made) = scene();
    let flat = largest(&made.asset);
    made.asset.splats[flat].curvature = DVec2::ZERO;
    let found = measured(&made.asset, &made, &input);
    println!("with a flat splat: {:?}, backward {:?}", found.holes, found.backward);
    assert!(found.holes.extra > 100 && found.backward.max > 5.0 * found.budget, "{found:?}");
}

#[test]
fn splats_that_go_on_over_a_hole_are_far_backward() {
    let (places, _, made) = scene();
    // Inside the ring, so that the box stays as it is.
    let gone = DVec3::new(0.0, 0.6, 0.0);
    let left: Vec<DVec3> = places.iter().copied().filter(|place| place.distance(gone) > 0.25).collect();
    let found = measured(&made.asset, &made, &input(&left));
    println!("without points: {:?}, backward {:?}", found.holes, found.backward);
    assert!(found.backward.max > 10.0 * found.budget, "{:?}", found.backward);
}

#[test]
fn what_stands_out_past_a_border_is_extra() {
    let mut draw = Draw(22);
    let places: Vec<DVec3> = (0..20_000).map(|_| DVec3::new(draw.both(), draw.both(), 0.0)).collect();
    let input = input(&places);
    let made = baked(&input);
    let sound = measured(&made.asset, &made, &input);
    println!("sound: {:?}, backward {:?} of {}", sound.holes, sound.backward, sound.budget);
    assert_eq!(sound.holes.missing, 0, "{:?}", sound.holes);
    let mut wide = made.asset.clone();
    for splat in &mut wide.splats {
        splat.radii *= 1.1;
    }
    let found = measured(&wide, &made, &input);
    println!("wider: {:?}, backward {:?} of {}", found.holes, found.backward, found.budget);
    assert!(found.holes.extra > sound.holes.extra + 1000, "{:?}", found.holes);
    assert!(found.backward.max > sound.backward.max + 0.01, "{:?}", found.backward);
}
