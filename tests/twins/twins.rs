//! The same scenes by the CPU reference and by wgpu, compared by pixel statistics and FLIP.

use std::io::Write;

use glam::DVec3;
use image::RgbaImage;
use qsplat::error::Error;
use qsplat::model::asset::Asset;
use qsplat::model::frame::Frame;
use qsplat::render::camera::{Camera, Framing, Projection, View};
use qsplat::render::gpu::Gpu;
use qsplat::render::{Settings, Show, cpu};

use crate::scenes;

/// Pixels may differ by this many levels of 255 without being counted.
const LEVELS: u8 = 3;
/// At most this fraction of the pixels may differ by more: hits at a rim, where 32 bits and 64
/// decide otherwise.
const OUTLIERS: f64 = 1e-3;
/// Greatest mean FLIP.
const MEAN_FLIP: f32 = 1e-3;

/// A shape so far from 0 or 1 that 32 bits can just tell.
const BESIDE: f64 = f32::EPSILON as f64;

/// The adapter. Without one the comparison is left out, which is said on standard error even
/// when the test passes; where CI or QSPLAT_REQUIRE_GPU say so it is an error.
#[allow(clippy::explicit_write)] // `eprintln` is held back by the test harness
fn gpu() -> Option<Gpu> {
    let fault = match Gpu::new() {
        Ok(gpu) => return Some(gpu),
        Err(fault) => fault,
    };
    let set = |name: &str, value: &str| std::env::var(name).is_ok_and(|given| given == value);
    assert!(!set("CI", "true") && !set("QSPLAT_REQUIRE_GPU", "1"), "the twins cannot be compared: {fault}");
    writeln!(std::io::stderr(), "\n*** NO GRAPHICS ADAPTER: THE TWINS ARE NOT COMPARED ***\n{fault}\n")
        .unwrap();
    None
}

/// Mean FLIP between two opaque pictures.
fn flip(a: &RgbaImage, b: &RgbaImage) -> f32 {
    let rgb = |image: &RgbaImage| {
        let bytes: Vec<u8> = image.pixels().flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
        nv_flip::FlipImageRgb8::with_data(image.width(), image.height(), &bytes)
    };
    let map = nv_flip::flip(rgb(a), rgb(b), nv_flip::DEFAULT_PIXELS_PER_DEGREE);
    nv_flip::FlipPool::from_image(&map).mean()
}

/// Draws one picture twice and compares; returns how many pixels are not background.
fn compare(name: &str, gpu: &Gpu, asset: &Asset, camera: &Camera, settings: &Settings) -> usize {
    let reference = cpu::render(asset, camera, settings).unwrap().rgba;
    let drawn = gpu.render(asset, camera, settings).unwrap().rgba;
    let differs = |a: &image::Rgba<u8>, b: &image::Rgba<u8>| (0..4).any(|n| a[n].abs_diff(b[n]) > LEVELS);
    let outliers = reference.pixels().zip(drawn.pixels()).filter(|(a, b)| differs(a, b)).count();
    let pixels = (reference.width() * reference.height()) as usize;
    let flip = flip(&reference, &drawn);
    println!("{name} {}: {outliers} of {pixels} pixels differ, FLIP {flip:.6}", settings.show.name());
    assert!(outliers as f64 <= OUTLIERS * pixels as f64, "{name} {:?}: {outliers} outliers", settings.show);
    assert!(flip <= MEAN_FLIP, "{name} {:?}: FLIP {flip}", settings.show);
    reference.pixels().filter(|pixel| pixel.0 != settings.background).count()
}

fn all_scenes() -> Vec<(&'static str, Asset)> {
    vec![
        ("sphere", scenes::sphere(300, 0.8, true)),
        ("flat sphere", scenes::sphere(300, 0.8, false)),
        ("cylinder", scenes::cylinder(16, 0.5, 1.2)),
        ("corner", scenes::corner()),
        ("chord", scenes::clipped(0.0, false)),
        ("parabola", scenes::clipped(0.5, false)),
        ("control polygon", scenes::clipped(1.0, false)),
        ("beside the chord", scenes::clipped(BESIDE, false)),
        ("beside the control polygon", scenes::clipped(1.0 - BESIDE, false)),
        ("arc over 180 degrees", scenes::wide_arc(0.5)),
        ("corner over 180 degrees", scenes::wide_arc(1.0)),
        ("partners", scenes::partnered()),
        ("three clips", scenes::clipped(0.4, true)),
        ("needles", scenes::needles()),
        ("clipped needles", scenes::clipped_needles()),
        ("all kinds", scenes::all_kinds()),
    ]
}

#[test]
fn every_show_of_every_scene_agrees() {
    let Some(gpu) = gpu() else { return };
    for (name, asset) in all_scenes() {
        for show in Show::ALL {
            for framing in [Framing::default(), Framing::Orthographic] {
                let settings = Settings { size: [160, 120], show, ..Settings::default() };
                let view = View::Angles { azimuth: 35.0, elevation: 25.0 };
                let camera = Camera::framing(&asset.frame, asset.diagonal, view, framing, settings.size);
                let shown = compare(name, &gpu, &asset, &camera, &settings);
                assert!(shown > 50, "{name}: only {shown} pixels");
            }
        }
    }
}

#[test]
fn hard_cameras_agree() {
    let Some(gpu) = gpu() else { return };
    let camera = |eye: [f64; 3], target: [f64; 3], projection| Camera {
        eye,
        target,
        up: [0.0, 1.0, 0.0],
        projection,
        near: None,
    };
    let perspective = |fov_degrees| Projection::Perspective { fov_degrees };
    // On the axis, pixels would lie on an edge, of whose sides rounding alone decides.
    let off_axis = [0.011, 0.007, 3.0];
    let cameras = [
        ("inside", camera([0.1, 0.2, 0.0], [1.0, 0.4, 0.3], perspective(100.0))),
        ("touching", camera([0.0, 0.0, 0.81], [0.3, 0.0, 0.5], perspective(60.0))),
        ("grazing", camera([1.5, 0.8, 0.0], [0.0, 0.78, 0.0], perspective(20.0))),
        ("telephoto", camera([3e4, 1e4, 2e4], [0.0; 3], perspective(0.003))),
        ("near cuts", Camera { near: Some(2.6), ..camera(off_axis, [0.0; 3], perspective(40.0)) }),
        ("far parallel", camera([0.0, 0.0, 1e5], [0.0; 3], Projection::Orthographic { height: 1.9 })),
        ("close up", camera([0.3, 0.3, 0.75], [0.25, 0.25, 0.7], perspective(30.0))),
    ];
    for (view, camera) in cameras {
        for (name, asset) in [("sphere", scenes::sphere(300, 0.8, true)), ("all kinds", scenes::all_kinds())]
        {
            for show in [Show::Shaded, Show::Normals, Show::Depth] {
                let settings = Settings { size: [160, 120], show, ..Settings::default() };
                compare(&format!("{view} {name}"), &gpu, &asset, &camera, &settings);
            }
        }
    }
}

#[test]
fn a_clipped_needle_agrees_close_up() {
    let Some(gpu) = gpu() else { return };
    let camera = Camera {
        eye: [0.0, 0.0, 1.0],
        target: [0.0; 3],
        up: [0.0, 1.0, 0.0],
        projection: Projection::Orthographic { height: 0.003 },
        near: None,
    };
    for rho in [0.0, BESIDE, 0.5, 1.0 - BESIDE, 1.0] {
        let asset = scenes::clipped_needle(rho);
        for show in [Show::Shaded, Show::Normals, Show::Depth] {
            let settings = Settings { size: [160, 120], show, ..Settings::default() };
            let shown = compare(&format!("needle of shape {rho}"), &gpu, &asset, &camera, &settings);
            // Half of a strip that is a third as high as the picture, and less for the curve.
            assert!((1500..4500).contains(&shown), "{shown} pixels");
        }
    }
}

#[test]
fn place_and_scale_of_the_model_do_not_matter() {
    let Some(gpu) = gpu() else { return };
    for (origin, exponent) in [(DVec3::new(4e6, 5e5, 5e6), -3), (DVec3::ZERO, 30), (DVec3::splat(1e-9), -40)]
    {
        let asset = Asset { frame: Frame { origin, exponent }, ..scenes::sphere(100, 0.8, true) };
        let settings = Settings { size: [100, 100], ..Settings::default() };
        let camera =
            Camera::framing(&asset.frame, asset.diagonal, View::Iso, Framing::default(), settings.size);
        assert!(compare(&format!("at {origin}"), &gpu, &asset, &camera, &settings) > 1000);
    }
}

#[test]
fn only_the_classes_that_are_there_get_pipelines() {
    let Some(gpu) = gpu() else { return };
    for (asset, classes) in [
        (scenes::asset(Vec::new(), 0.001), 0),
        (scenes::corner(), 1),
        (scenes::needles(), 2),
        (scenes::all_kinds(), 4),
    ] {
        assert_eq!(gpu.load(&asset).unwrap().classes(), classes);
    }
}

#[test]
fn an_empty_asset_is_all_background() {
    let asset = scenes::asset(Vec::new(), 0.001);
    let settings = Settings { size: [7, 5], background: [10, 20, 30, 40], ..Settings::default() };
    let camera =
        Camera::framing(&asset.frame, asset.diagonal, View::Front, Framing::default(), settings.size);
    let mut pictures = vec![cpu::render(&asset, &camera, &settings).unwrap()];
    pictures.extend(gpu().map(|gpu| gpu.render(&asset, &camera, &settings).unwrap()));
    for picture in pictures {
        assert!(picture.rgba.pixels().all(|pixel| pixel.0 == settings.background));
    }
}

#[test]
fn too_large_a_picture_is_an_error_with_a_remedy() {
    let Some(gpu) = gpu() else { return };
    let asset = scenes::corner();
    let settings = Settings { size: [16_000, 1_500], ..Settings::default() };
    let camera =
        Camera::framing(&asset.frame, asset.diagonal, View::Front, Framing::default(), settings.size);
    match gpu.render(&asset, &camera, &settings) {
        Err(Error::Device(message)) => assert!(message.contains("smaller size"), "{message}"),
        other => panic!("{:?}", other.map(|picture| picture.rgba.dimensions())),
    }
}
