//! Clouds that are hardly clouds: each ends in a result or a clear error.

use glam::DVec3;
use qsplat::bake::{MaxError, Silent};
use qsplat::deliver::deliver;
use qsplat::error::Error;
use qsplat::ingest::Input;

use super::scene::{Draw, bake, cloud, options};

#[test]
fn few_and_degenerate_points() {
    let mut draw = Draw(31);
    let mut place = || DVec3::new(draw.both(), draw.both(), draw.both());
    let mut cases: Vec<(String, Vec<DVec3>)> =
        (2..=7).map(|count| (format!("{count} points"), (0..count).map(|_| place()).collect())).collect();
    let line = |n: i32| DVec3::new(1.0, 2.0, -0.5) * f64::from(n * n % 101);
    cases.push(("on a line".into(), (0..100).map(line).collect()));
    cases.push(("on a plane".into(), (0..400).map(|_| place() * DVec3::new(1.0, 1.0, 0.0)).collect()));
    let lattice = |n: i32| DVec3::new(f64::from(n % 12), f64::from(n / 12 % 12), f64::from(n / 144));
    cases.push(("a solid lattice".into(), (0..1728).map(lattice).collect()));
    cases.push(("a flat lattice".into(), (0..144).map(lattice).collect()));
    cases.push(("noise".into(), (0..2000).map(|_| place()).collect()));
    let circle = |n: i32| DVec3::new(f64::from(n).cos(), f64::from(n).sin(), 0.0);
    cases.push(("on a circle".into(), (0..300).map(circle).collect()));
    let scan = |n: i32| DVec3::new(f64::from(n % 500) * 0.02, f64::from(n / 500), 0.0);
    cases.push(("scan lines, 1 to 50".into(), (0..5000).map(scan).collect()));
    for (name, places) in &cases {
        let made = bake(&cloud(places, &[]), &options(MaxError::Absolute(0.02)));
        assert!(made.asset.fit.max <= made.asset.max_error, "{name}");
        assert!(!made.asset.splats.is_empty(), "{name}");
        let few = places.len() < 10 || ["noise", "a solid lattice"].contains(&name.as_str());
        assert!(few || made.baked.choice.last_resorts < places.len() / 4, "{name}");
        println!("{name}: {} splats, {} left out", made.asset.splats.len(), made.baked.left_out.len());
    }
}

#[test]
fn points_of_one_place_are_no_surface() {
    for count in [1, 9] {
        let cloud = cloud(&vec![DVec3::new(3.0, 4.0, 5.0); count], &[]);
        for bound in [MaxError::Relative(1e-3), MaxError::Absolute(0.1)] {
            let refused = deliver(&Input::Cloud(cloud.clone()), &options(bound), &mut Silent);
            assert!(matches!(refused, Err(Error::Usage(text)) if text.contains("one place")));
        }
    }
}
