//! The CPU reference against surfaces whose pictures are known.

use glam::{DVec2, DVec3};
use qsplat::model::asset::Asset;
use qsplat::model::clip_curve::ClipCurve;
use qsplat::model::splat::Splat;
use qsplat::render::camera::{Camera, Framing, Projection, View};
use qsplat::render::{Settings, Show, cpu};

use crate::scenes;

/// An orthographic camera that looks along `-Z` at a square of this side.
fn straight(side: f64) -> Camera {
    Camera {
        eye: [0.0, 0.0, 3.0],
        target: [0.0; 3],
        up: [0.0, 1.0, 0.0],
        projection: Projection::Orthographic { height: side },
        near: None,
    }
}

/// Where the middle of a pixel lies in the plane that [`straight`] looks at.
fn spot(x: u32, y: u32, size: u32, side: f64) -> DVec2 {
    let unit = side / f64::from(size);
    DVec2::new((f64::from(x) + 0.5) * unit - 0.5 * side, 0.5 * side - (f64::from(y) + 0.5) * unit)
}

#[test]
fn a_sphere_of_splats_is_a_sphere() {
    let (radius, size) = (0.8, 300);
    let asset = scenes::sphere(2000, radius, true);
    let seen = cpu::visibility(&asset, &straight(2.0), [size, size]).unwrap();
    let (mut holes, mut worst_depth, mut worst_normal) = (0, 0.0_f64, 0.0_f64);
    for (x, y) in (0..size).flat_map(|y| (0..size).map(move |x| (x, y))) {
        let p = spot(x, y, size, 2.0);
        let hit = seen.at(x, y);
        // A pixel's width inside the outline.
        if p.length() < radius - 0.01 {
            let height = (radius * radius - p.length_squared()).sqrt();
            let normal = p.extend(height) / radius;
            let Some(hit) = hit else {
                holes += 1;
                continue;
            };
            // Along the normal: the depth's error times the cosine.
            worst_depth = worst_depth.max((3.0 - hit.depth - height).abs() * normal.z);
            let cosine = DVec3::from(hit.normal.map(f64::from)).dot(normal);
            worst_normal = worst_normal.max(libm::acos(cosine.min(1.0)).to_degrees());
        } else if p.length() > radius + 0.01 {
            assert!(hit.is_none(), "({x}, {y}) is outside");
        }
    }
    println!("worst distance {worst_depth:e} of {:e}, worst angle {worst_normal:.3}", asset.max_error);
    assert_eq!(holes, 0);
    assert!(worst_depth < 1.05 * asset.max_error, "{worst_depth}");
    assert!(worst_normal < 0.2, "{worst_normal}");
}

#[test]
fn blended_normals_beat_the_nearest_alone() {
    let (radius, size) = (0.8, 200);
    let asset = scenes::sphere(800, radius, false);
    let settings = Settings { size: [size, size], show: Show::Normals, ..Settings::default() };
    let picture = cpu::render(&asset, &straight(2.0), &settings).unwrap().rgba;
    let seen = cpu::visibility(&asset, &straight(2.0), settings.size).unwrap();
    let (mut blended, mut nearest, mut count) = (0.0, 0.0, 0.0);
    for (x, y, pixel) in picture.enumerate_pixels() {
        let p = spot(x, y, size, 2.0);
        if let (Some(hit), true) = (seen.at(x, y), p.length() < 0.7) {
            let truth = p.extend((radius * radius - p.length_squared()).sqrt()) / radius;
            let drawn =
                DVec3::new(f64::from(pixel[0]), f64::from(pixel[1]), f64::from(pixel[2])) / 127.5 - 1.0;
            blended += drawn.normalize().angle_between(truth);
            nearest += DVec3::from(hit.normal.map(f64::from)).angle_between(truth);
            count += 1.0;
        }
    }
    println!(
        "mean angle: blended {:.3}, nearest {:.3} degrees",
        blended / count * 57.3,
        nearest / count * 57.3
    );
    assert!(count > 10_000.0 && blended < 0.6 * nearest);
}

#[test]
fn nothing_blends_across_an_edge_or_a_gap() {
    let size = 120;
    let settings =
        Settings { size: [size, size], show: Show::Normals, antialias: false, ..Settings::default() };
    let asset = scenes::corner();
    for view in [View::Iso, View::Angles { azimuth: 20.0, elevation: 50.0 }] {
        let camera = Camera::framing(&asset.frame, asset.diagonal, view, Framing::default(), settings.size);
        let picture = cpu::render(&asset, &camera, &settings).unwrap().rgba;
        let allowed = [[255, 128, 128], [128, 255, 128], [128, 128, 255], [255; 3]];
        for pixel in picture.pixels() {
            let rgb = [pixel[0], pixel[1], pixel[2]];
            let near = |want: &[u8; 3]| (0..3).all(|n| want[n].abs_diff(rgb[n]) <= 1);
            assert!(allowed.iter().any(near), "{rgb:?} is a mixture");
        }
    }
}

#[test]
fn a_sheet_behind_blends_only_within_the_band() {
    let disc = |z: f64, color: [u8; 3]| {
        let axes = scenes::axes(DVec3::Z);
        Splat { color, ..scenes::splat(DVec3::Z * z, axes, DVec2::splat(0.9), DVec2::ZERO) }
    };
    let error = 0.01;
    for (gap, blends) in [(3.9 * error, true), (4.1 * error, false)] {
        let splats = vec![disc(0.0, [255, 0, 0]), disc(-gap, [0, 0, 255])];
        let asset = Asset { has_colors: true, ..scenes::asset(splats, error) };
        let settings = Settings::plain([9, 9]);
        let picture = cpu::render(&asset, &straight(1.0), &settings).unwrap().rgba;
        assert_eq!(picture.get_pixel(4, 4)[2] > 100, blends, "gap {gap}");
    }
}

#[test]
fn what_a_clip_cuts_away_is_gone_to_the_pixel() {
    let size = 200;
    for rho in [0.0, 0.25, 0.5, 0.8, 1.0] {
        let clip = ClipCurve { alpha1: 5.4, alpha3: 1.1, p2: DVec2::new(-0.2, 0.1), rho };
        let axes = glam::DMat3::IDENTITY;
        let bowl = scenes::splat(DVec3::ZERO, axes, DVec2::new(0.9, 0.6), DVec2::new(0.3, -0.2));
        let splat = Splat { clips: vec![clip], ..bowl };
        let seen =
            cpu::visibility(&scenes::asset(vec![splat.clone()], 0.01), &straight(2.0), [size, size]).unwrap();
        let mut cut = 0;
        for (x, y) in (0..size).flat_map(|y| (0..size).map(move |x| (x, y))) {
            let uv = spot(x, y, size, 2.0);
            // Numbers that are equal on paper may differ in the last bits on a border.
            let near = [DVec2::X, DVec2::Y].map(|axis| axis * 1e-9);
            let sure = near.iter().all(|d| splat.covers(uv + d) == splat.covers(uv - d));
            if sure {
                assert_eq!(seen.at(x, y).is_some(), splat.covers(uv), "rho {rho} at {uv}");
            }
            cut += usize::from(splat.ellipse(uv) <= 1.0 && !splat.covers(uv));
        }
        assert!(cut > 500, "rho {rho} cuts {cut} pixels");
    }
}

#[test]
fn both_sides_are_seen_and_face_the_eye() {
    let asset = scenes::asset(
        vec![scenes::splat(
            DVec3::ZERO,
            scenes::axes(DVec3::new(0.3, 0.1, 1.0)),
            DVec2::splat(0.5),
            DVec2::splat(0.4),
        )],
        0.001,
    );
    for eye in [3.0, -3.0] {
        let camera = Camera { eye: [0.0, 0.0, eye], ..straight(2.0) };
        let seen = cpu::visibility(&asset, &camera, [50, 50]).unwrap();
        let hits: Vec<_> = seen.seen.iter().flatten().collect();
        assert!(hits.len() > 300);
        assert!(hits.iter().all(|hit| f64::from(hit.normal[2]) * eye > 0.0));
    }
}

/// The nearest hit of a ray by brute force: signs of the height above the quadric at many
/// places along the ray, then bisection. Knows nothing of bounds, tiles or roots.
fn nearest_by_search(splats: &[Splat], eye: DVec3, direction: DVec3) -> Option<f64> {
    let hits = splats.iter().flat_map(|splat| {
        let above = |t: f64| {
            let p = splat.to_local(eye + t * direction);
            p.z - splat.height(p.truncate())
        };
        let (middle, reach) = ((splat.center - eye).dot(direction), splat.bounding_radius());
        let at = move |n: i32| middle + reach * f64::from(n) / 100.0;
        let crossing = move |n: &i32| above(at(*n)) * above(at(n + 1)) <= 0.0;
        (-100..100).filter(crossing).filter_map(move |n| {
            let (mut a, mut b) = (at(n), at(n + 1));
            for _ in 0..60 {
                let c = 0.5 * (a + b);
                (a, b) = if above(a) * above(c) <= 0.0 { (a, c) } else { (c, b) };
            }
            let p = splat.to_local(eye + a * direction);
            (a > 0.0 && splat.covers(p.truncate())).then_some(a)
        })
    });
    hits.min_by(f64::total_cmp)
}

#[test]
fn nothing_is_lost_and_nothing_added() {
    // A picture that ends within a tile, taken from inside, with splats on both sides of the
    // near plane.
    let all = scenes::all_kinds();
    let splats: Vec<Splat> =
        all.splats.iter().step_by(6).chain(&scenes::clipped(0.7, true).splats).cloned().collect();
    let asset = Asset { splats, ..all };
    let (eye, size) = (DVec3::new(0.4, 0.3, 0.9), [77, 45]);
    let forward = (DVec3::new(-0.2, 0.1, -0.3) - eye).normalize();
    let right = forward.cross(DVec3::Y).normalize();
    let camera = Camera {
        eye: eye.into(),
        target: (eye + forward).into(),
        up: [0.0, 1.0, 0.0],
        projection: Projection::Perspective { fov_degrees: 95.0 },
        near: Some(1e-6),
    };
    let seen = cpu::visibility(&asset, &camera, size).unwrap();
    let unit = 2.0 * libm::tan(95.0_f64.to_radians() / 2.0) / f64::from(size[1]);
    let (mut hits, mut odd) = (0, 0);
    for (x, y) in (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y))) {
        let plane = DVec2::new(f64::from(x) + 0.5 - 38.5, 22.5 - f64::from(y) - 0.5) * unit;
        let direction = forward + plane.x * right + plane.y * right.cross(forward);
        let found =
            nearest_by_search(&asset.splats, eye, direction.normalize()).map(|t| t / direction.length());
        let seen = seen.at(x, y).map(|hit| hit.depth);
        hits += usize::from(seen.is_some());
        odd += match (found, seen) {
            (Some(a), Some(b)) => usize::from((a - b).abs() > 1e-9),
            (None, None) => 0,
            _ => 1,
        };
    }
    println!("{hits} hits, {odd} differ from the search");
    // The search steps over both crossings of a ray that barely grazes.
    assert!(hits > 1500 && odd <= 3, "{hits} hits, {odd} differ");
}

#[test]
fn the_number_of_threads_does_not_matter() {
    let asset = scenes::all_kinds();
    let settings = Settings { size: [150, 110], ..Settings::default() };
    let camera = Camera::framing(&asset.frame, asset.diagonal, View::Iso, Framing::default(), settings.size);
    let draw = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| cpu::render(&asset, &camera, &settings).unwrap())
    };
    let one = draw(1);
    assert!([2, 3, 7].into_iter().all(|threads| draw(threads) == one));
}

#[test]
fn antialiasing_averages_in_linear_light() {
    // A half plane whose edge runs through the middle of a pixel.
    let half = Splat {
        clips: vec![ClipCurve::chord(1.5 * std::f64::consts::PI, 0.5 * std::f64::consts::PI)],
        color: [0; 3],
        ..scenes::splat(DVec3::ZERO, glam::DMat3::IDENTITY, DVec2::splat(0.9), DVec2::ZERO)
    };
    let asset = Asset { has_colors: true, ..scenes::asset(vec![half], 0.001) };
    let mut settings = Settings { size: [5, 5], ..Settings::default() };
    settings.light.specular = 0.0;
    let picture = cpu::render(&asset, &straight(1.0), &settings).unwrap().rgba;
    let row: Vec<u8> = (0..5).map(|x| picture.get_pixel(x, 2)[0]).collect();
    // Half of white light is 188 in sRGB (IEC 61966-2-1).
    assert_eq!(row, [0, 0, 188, 255, 255]);
}
