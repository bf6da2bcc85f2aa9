//! Noisy clouds: refused with advice, or smoothed as asked.

use glam::DVec3;
use qsplat::bake::{Edges, Made, MaxError, Options, Silent, meant};
use qsplat::deliver::deliver;
use qsplat::error::Error;
use qsplat::ingest::Input;
use qsplat::model::polyline::Polylines;

use super::scene::{Draw, bake, cloud, options};

/// Standard deviation of the points, a fraction of the sphere's radius.
const NOISE: f64 = 5e-3;

/// An error bound below three times the noise, in radii.
const BOUND: f64 = 6e-3;

/// Places that scatter about the unit sphere.
fn noisy_sphere(count: usize) -> Vec<DVec3> {
    let mut draw = Draw(77);
    let place = |_| {
        // About normal, of variance 1 (Irwin and Hall).
        let mut normal = || (0..12).map(|_| draw.one()).sum::<f64>() - 6.0;
        let off = DVec3::new(normal(), normal(), normal());
        draw.direction() + NOISE * off
    };
    (0..count).map(place).collect()
}

#[test]
fn a_bound_below_the_noise_is_refused_with_one_that_is_not() {
    let cloud = cloud(&noisy_sphere(20_000), &[]);
    let refused = deliver(&Input::Cloud(cloud.clone()), &options(MaxError::Absolute(BOUND)), &mut Silent);
    let Err(Error::Usage(text)) = refused else { panic!("not refused: {refused:?}") };
    let advised = text.split("--max-error of ").nth(1).and_then(|rest| rest.split(' ').next()).unwrap();
    assert!(text.contains("--denoise"), "{text}");
    let made = bake(&cloud, &options(MaxError::Absolute(advised.parse().unwrap())));
    assert_eq!(made.baked.made, Made::Itself);
}

#[test]
fn what_is_only_measured_is_not_refused() {
    let input = Input::Cloud(cloud(&noisy_sphere(20_000), &[]));
    let options = options(MaxError::Absolute(BOUND));
    let meant = meant(&input, &options, BOUND / input.cloud().frame.scale()).unwrap();
    let noise = meant.noise.unwrap() * input.cloud().frame.scale();
    assert_eq!(meant.made, Made::Itself);
    assert!((0.75..1.25).contains(&(noise / NOISE)), "{noise}");
}

#[test]
fn a_smoothed_cloud_is_the_sphere_it_was_taken_from() {
    let mut places = noisy_sphere(20_000);
    let options = Options { denoise: true, ..options(MaxError::Absolute(BOUND)) };
    let made = bake(&cloud(&places, &[]), &options);
    let Made::Quiet(quiet) = made.baked.made else { panic!("not smoothed") };
    let scale = made.asset.frame.scale();
    assert!((0.8..1.2).contains(&(quiet.moved_rms * scale / NOISE)), "{quiet:?}");
    // A sphere needs some forty splats at this bound; the noise would need thousands.
    assert!(made.asset.splats.len() < 150, "{}", made.asset.splats.len());
    for splat in &made.asset.splats {
        let center = made.asset.frame.to_input(splat.center);
        assert!((center.length() - 1.0).abs() < 2.0 * BOUND, "{center}");
    }
    Draw(5).shuffle(&mut places);
    assert_eq!(made.bytes, bake(&cloud(&places, &[]), &options).bytes, "the order of points");
}

#[test]
fn what_no_smoothing_helps_is_refused_too() {
    let options = Options { denoise: true, ..options(MaxError::Absolute(1e-4)) };
    let refused = deliver(&Input::Cloud(cloud(&noisy_sphere(20_000), &[])), &options, &mut Silent);
    let Err(Error::Usage(text)) = refused else { panic!("not refused: {refused:?}") };
    assert!(text.contains("--max-error") && !text.contains("--denoise"), "{text}");
}

#[test]
fn a_bound_above_the_noise_that_bumps_would_show_at_is_smoothed_as_asked() {
    let cloud = cloud(&noisy_sphere(20_000), &[]);
    let bound = options(MaxError::Absolute(4.0 * NOISE));
    let plain = bake(&cloud, &bound);
    let smoothed = bake(&cloud, &Options { denoise: true, ..bound });
    assert_eq!(plain.baked.made, Made::Itself);
    let Made::Quiet(quiet) = smoothed.baked.made else { panic!("not smoothed") };
    assert!(quiet.left.unwrap() < 0.25 * smoothed.asset.max_error, "{quiet:?}");
    assert!(smoothed.bytes.len() <= plain.bytes.len(), "{} {}", smoothed.bytes.len(), plain.bytes.len());
}

#[test]
fn points_strewn_through_space_are_no_noise_that_can_be_smoothed() {
    // Half of the points on the ground, half anywhere above it, as in a wood.
    let mut draw = Draw(78);
    let mut height = || if draw.one() < 0.5 { 0.0 } else { 0.2 * draw.one() };
    let heights: Vec<f64> = (0..8000).map(|_| height()).collect();
    let wood: Vec<DVec3> = heights.into_iter().map(|z| DVec3::new(draw.both(), draw.both(), z)).collect();
    let options = Options { denoise: true, ..options(MaxError::Relative(5e-3)) };
    let refused = deliver(&Input::Cloud(cloud(&wood, &[])), &options, &mut Silent);
    let Err(Error::Usage(text)) = refused else { panic!("not refused") };
    assert!(text.contains("--max-error") && text.contains("do not smooth to a surface"), "{text}");
}

#[test]
fn what_became_of_given_lines_is_told_by_their_numbers_also_of_a_smoothed_cloud() {
    // A roof, whose points scatter by half of what they lie apart.
    let mut draw = Draw(79);
    let mut place = || {
        let mut normal = || (0..12).map(|_| draw.one()).sum::<f64>() - 6.0;
        let off = 0.01 * DVec3::new(normal(), normal(), normal());
        let (x, y) = (draw.both(), draw.both());
        DVec3::new(x, y, -y.abs()) + off
    };
    let cloud = cloud(&(0..10_000).map(|_| place()).collect::<Vec<_>>(), &[]);
    let line = |a: [f64; 3], b: [f64; 3]| vec![DVec3::from_array(a), DVec3::from_array(b)];
    let seam = line([-0.9, 0.5, -0.5], [0.9, 0.5, -0.5]);
    let far = line([5.0, 5.0, 5.0], [6.0, 5.0, 5.0]);
    let crease = line([-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
    let lines = Polylines { lines: vec![seam, far, crease] };
    let edges = Edges::Given(lines.clone());
    for (denoise, bound) in [(false, 0.05), (true, 0.02)] {
        let options = Options { edges: edges.clone(), denoise, ..options(MaxError::Absolute(bound)) };
        let made = bake(&cloud, &options);
        assert_eq!(matches!(made.baked.made, Made::Quiet(_)), denoise);
        let matched = made.baked.features.matched.unwrap();
        assert_eq!(lines.whole(&matched.lost), [1], "smoothed: {denoise}");
        let smooth = matched.smooth_length * cloud.frame.scale();
        assert!((smooth - 1.8).abs() < 1e-3, "smoothed: {denoise}: {smooth}");
    }
}
