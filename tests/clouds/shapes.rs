//! Spheres, tori, sheets and holes.

use glam::{DVec3, Vec3};
use qsplat::analyse::cloud_surface::OpenPlace;
use qsplat::bake::Silent;
use qsplat::bake::{MaxError, Normals, kept, meant};
use qsplat::deliver::{self, deliver};
use qsplat::error::Error;
use qsplat::ingest::Input;
use qsplat::measure::{Reference, Subject, measure};

use super::scene::{Draw, bake, bare, cloud, options, surface};

fn sphere(count: usize, seed: u64) -> Vec<DVec3> {
    let mut draw = Draw(seed);
    (0..count).map(|_| draw.direction()).collect()
}

#[test]
fn a_sphere_without_normals_comes_out_whole_and_outside_out() {
    let cloud = cloud(&sphere(6000, 1), &[]);
    let made = bake(&cloud, &options(MaxError::Relative(1e-3)));
    let truth: Vec<Vec3> =
        sphere(20_000, 2).iter().map(|&place| cloud.frame.to_model(place).as_vec3()).collect();
    assert_eq!(bare(&made, &truth, 2.0 * made.asset.max_error), 0, "no hole anywhere on the sphere");
    let middle = cloud.frame.to_model(DVec3::ZERO);
    for splat in &made.asset.splats {
        let outward = (splat.center - middle).normalize();
        assert!(splat.axes.z_axis.dot(outward) > 0.999, "{:?}", splat.axes.z_axis);
    }
    assert!(made.asset.splats.len() < 60, "{}", made.asset.splats.len());
    assert_eq!(made.baked.choice.last_resorts, 0);
    assert!(made.baked.open_places.is_empty(), "{:?}", made.baked.open_places);
}

#[test]
fn points_too_far_apart_for_the_bound_are_told_and_only_where_the_surface_bends() {
    // A roof that turns by some degrees, too few for a crease, with about 0.016 from point to point.
    let told = |degrees: f64| {
        let slope = (0.5 * degrees).to_radians().tan();
        let mut draw = Draw(7);
        let mut place = || {
            let (x, y) = (draw.both(), draw.both());
            DVec3::new(x, y, -slope * y.abs())
        };
        let cloud = cloud(&(0..16_000).map(|_| place()).collect::<Vec<_>>(), &[]);
        let sparse = bake(&cloud, &options(MaxError::Relative(2e-4))).baked.sparse;
        sparse.map(|sparse| (sparse, cloud.frame.to_input(sparse.worst)))
    };
    assert_eq!(told(0.0), None);
    // Half a margin times 0.35 is 0.0015 or more, the bound 0.0006.
    let (sparse, worst) = told(20.0).unwrap();
    assert!(worst.y.abs() < 0.05 && (100..1000).contains(&sparse.points), "{sparse:?} around {worst}");
    assert!((1e-3..2e-2).contains(&sparse.by), "{sparse:?}");
}

#[test]
fn normals_are_kept_or_estimated_as_asked() {
    let places = sphere(3000, 3);
    let inward: Vec<DVec3> = places.iter().map(|place| -3.0 * *place).collect();
    let looks = |normals: &[DVec3], how: Normals| {
        let cloud = cloud(&places, normals);
        let made = bake(&cloud, &qsplat::bake::Options { normals: how, ..options(MaxError::Relative(2e-3)) });
        let out = made.asset.splats.iter().filter(|splat| splat.axes.z_axis.dot(splat.center) > 0.0).count();
        (out, made.asset.splats.len() - out)
    };
    assert_eq!(looks(&inward, Normals::Auto).0, 0, "kept, though they look inward");
    assert_eq!(looks(&inward, Normals::Keep).0, 0);
    assert_eq!(looks(&inward, Normals::Estimate).1, 0);
    let mut draw = Draw(4);
    let random: Vec<DVec3> = inward.iter().map(|n| if draw.one() < 0.5 { *n } else { -*n }).collect();
    assert_eq!(looks(&random, Normals::Auto).1, 0, "signs drawn at random mean nothing");
    let broken: Vec<DVec3> = places
        .iter()
        .map(|place| match (draw.one() * 20.0) as u32 {
            0 => DVec3::NAN,
            1 => DVec3::ZERO,
            2 => place.any_orthonormal_vector(),
            _ => *place,
        })
        .collect();
    assert_eq!(looks(&broken, Normals::Keep).1, 0, "a few unsound ones are mended");
    let keep = qsplat::bake::Options { normals: Normals::Keep, ..options(MaxError::Relative(2e-3)) };
    let refused = deliver(&Input::Cloud(cloud(&places, &[])), &keep, &mut Silent);
    assert!(matches!(refused, Err(Error::Usage(text)) if text.contains("--normals keep")));
}

#[test]
fn a_torus_has_no_holes_but_its_own() {
    let torus = |count: usize, seed: u64| -> Vec<DVec3> {
        let mut draw = Draw(seed);
        (0..count)
            .map(|_| {
                let (a, b) = (draw.one() * std::f64::consts::TAU, draw.one() * std::f64::consts::TAU);
                let r = 1.0 + 0.35 * b.cos();
                DVec3::new(r * a.cos(), r * a.sin(), 0.35 * b.sin())
            })
            .collect()
    };
    let cloud = cloud(&torus(12_000, 5), &[]);
    let made = bake(&cloud, &options(MaxError::Relative(2e-3)));
    let truth: Vec<Vec3> = torus(20_000, 6).iter().map(|&p| cloud.frame.to_model(p).as_vec3()).collect();
    assert_eq!(bare(&made, &truth, 2.0 * made.asset.max_error), 0);
    let scale = cloud.frame.scale();
    for splat in &made.asset.splats {
        for place in surface(splat) {
            let p = cloud.frame.to_input(place);
            let off = (DVec3::new(p.x, p.y, 0.0).length() - 1.0).hypot(p.z) - 0.35;
            assert!(off.abs() < 2.5 * made.asset.max_error * scale, "{off}");
        }
    }
}

#[test]
fn sheets_closer_than_a_few_spacings_stay_apart() {
    let mut draw = Draw(7);
    // The spacing is about 0.033; the sheets lie 0.05 apart.
    let places: Vec<DVec3> = (0..8000)
        .map(|n| DVec3::new(draw.both(), draw.both(), if n % 2 == 0 { 0.0 } else { 0.05 }))
        .collect();
    let normals: Vec<DVec3> = (0..8000).map(|n| if n % 2 == 0 { -DVec3::Z } else { DVec3::Z }).collect();
    let cloud = cloud(&places, &normals);
    let made = bake(&cloud, &options(MaxError::Relative(1e-3)));
    for splat in &made.asset.splats {
        let z = cloud.frame.to_input(splat.center).z;
        let upper = z > 0.025;
        for place in surface(splat) {
            let z = cloud.frame.to_input(place).z;
            assert!((z - if upper { 0.05 } else { 0.0 }).abs() < 0.01, "{z}");
        }
        assert_eq!(splat.axes.z_axis.z > 0.0, upper);
    }
}

#[test]
fn holes_and_borders_stay_where_they_are() {
    let spacing = 0.04;
    let lattice = (0..2500).map(|n| DVec3::new(f64::from(n % 50), f64::from(n / 50), 0.0) * spacing);
    let middle = DVec3::new(1.0, 1.0, 0.0);
    let places: Vec<DVec3> = lattice.filter(|p| p.distance(middle) > 0.3).collect();
    let cloud = cloud(&places, &[]);
    let made = bake(&cloud, &options(MaxError::Relative(1e-3)));
    let room = 1.5 * spacing + cloud.frame.scale() * made.asset.max_error;
    for place in made.asset.splats.iter().flat_map(surface) {
        let p = cloud.frame.to_input(place);
        let nearest = places.iter().map(|place| place.distance(p)).fold(f64::MAX, f64::min);
        assert!(p.min_element() > -room && p.max_element() < 1.96 + room, "{p} beyond the border");
        // Round a hole the cells reach into it: up to what is no hole yet.
        assert!(nearest < room + spacing, "{p} lies {nearest} from the cloud");
    }
    let [border, hole] = made.baked.open_places.as_slice() else { panic!("{:?}", made.baked.open_places) };
    let reach = |place: &OpenPlace| place.reach * cloud.frame.scale();
    assert_eq!(border.points, 4 * 49);
    assert!((reach(border) - 0.98 * std::f64::consts::SQRT_2).abs() < 1e-6, "{border:?}");
    assert!(cloud.frame.to_input(hole.middle).distance(middle) < spacing, "{hole:?}");
    assert!((0.3..0.5).contains(&reach(hole)), "{hole:?}");
    assert!(made.asset.splats.len() < 400, "{}", made.asset.splats.len());
    println!("a plane with a hole: {} splats of {} points", made.asset.splats.len(), places.len());
}

#[test]
fn outliers_are_left_out_and_told() {
    let mut places = sphere(5000, 8);
    let mut draw = Draw(9);
    let strays: Vec<DVec3> = (0..40).map(|_| 3.0 * draw.direction() * (1.0 + draw.one())).collect();
    let count = places.len() as u32;
    places.extend(&strays);
    let made = bake(&cloud(&places, &[]), &options(MaxError::Relative(5e-4)));
    assert_eq!(made.baked.left_out, (count..count + 40).collect::<Vec<_>>());
}

#[test]
fn what_is_measured_leaves_out_what_the_bake_did_and_keeps_the_bound() {
    let mut draw = Draw(10);
    let mut places = sphere(6000, 11);
    // One in twenty of all, anywhere in the box: some within a few spacings of the sphere.
    places.extend((0..300).map(|_| 1.5 * DVec3::new(draw.both(), draw.both(), draw.both())));
    // Strays side by side.
    places.extend((0..3).map(|n| DVec3::new(1.4, 1.4, 1.4 + 0.02 * f64::from(n))));
    draw.shuffle(&mut places);
    let options = options(MaxError::Relative(1e-3));
    let input = Input::Cloud(cloud(&places, &[]));
    let made = deliver(&input, &options, &mut Silent).unwrap();
    let max_error = made.asset.max_error;
    let meant = meant(&input, &options, max_error).unwrap();
    let kept = kept(&meant.input, &meant.edges, meant.noise, &options, max_error).unwrap();
    assert_eq!(kept.outliers, made.baked.left_out.len());
    assert_eq!(kept.input.cloud().positions, input.cloud().without(&made.baked.left_out).positions);
    for &stray in &made.baked.left_out {
        let place = input.cloud().frame.to_input(input.cloud().positions[stray as usize].as_dvec3());
        assert!((place.length() - 1.0).abs() > 0.02, "{place}");
    }
    let far = |p: &Vec3| (input.cloud().frame.to_input(p.as_dvec3()).length() - 1.0).abs() > 0.25;
    assert_eq!(kept.input.cloud().positions.iter().filter(|p| far(p)).count(), 0, "five spacings off");
    let reference = Reference::standing_for(deliver::surface(&kept), made.asset.diagonal).unwrap();
    let reference = Reference { outliers: kept.outliers, ..reference };
    let subject = Subject { bytes: &made.bytes, asset: &made.asset, against: &reference, lines: None };
    let measures = measure(&subject).unwrap();
    assert_eq!((measures.outliers, measures.uncovered), (kept.outliers as u64, 0));
    assert_eq!(measures.cost.input_points, places.len() as u64, "as read");
    assert!(measures.fit.max <= measures.budget && measures.forward.max <= measures.budget, "{measures:?}");
}
