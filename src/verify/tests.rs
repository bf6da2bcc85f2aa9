//! Goldens of planted splats: equal passes, one changed number fails and is shown.

#![allow(clippy::unwrap_used, clippy::panic)]
// A table of names and changes reads better than a name for its type.
#![allow(clippy::type_complexity)]

use glam::{DMat3, DVec2, DVec3};
use image::DynamicImage;

use super::*;
use crate::model::asset::Accuracy;
use crate::model::frame::Frame;
use crate::model::splat::Splat;
use crate::render::{Show, cpu};

/// A sphere of 6 x 6 x 6 - 4 x 4 x 4 caps, a little larger than they need to be.
fn ball() -> Asset {
    let mut splats = Vec::new();
    for n in 0..216 {
        let grid = [n % 6, n / 6 % 6, n / 36].map(|k| f64::from(k) - 2.5);
        let k = DVec3::from(grid);
        if k.abs().max_element() < 2.0 {
            continue;
        }
        let k = k.normalize();
        let i = k.any_orthonormal_vector();
        splats.push(Splat {
            center: 0.8 * k,
            axes: DMat3::from_cols(i, k.cross(i), k),
            radii: DVec2::splat(0.23),
            curvature: DVec2::splat(-0.5 / 0.8),
            clips: vec![],
            partners: Vec::new(),
            color: [255; 3],
        });
    }
    let fit = Accuracy { rms: 1e-3, p99: 2e-3, max: 3e-3 };
    let frame = Frame { origin: DVec3::new(1e6, 0.0, -7.0), exponent: 2 };
    Asset { frame, diagonal: 1.6 * 3.0_f64.sqrt(), max_error: 4e-3, fit, has_colors: false, splats }
}

fn reference(asset: &Asset) -> impl FnMut(&Camera, &Settings) -> Result<RgbImage> + '_ {
    |camera, settings| Ok(DynamicImage::from(cpu::render(asset, camera, settings)?.rgba).to_rgb8())
}

/// Blesses with pictures small enough for a quick test.
fn bless_small(asset: &Asset, directory: &Path) -> Golden {
    bless(asset, directory, Some([144, 144]), &mut reference(asset)).unwrap()
}

fn edit(directory: &Path, change: impl FnOnce(&mut serde_json::Value)) {
    let path = directory.join(golden::FILE);
    let mut json = serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
    change(&mut json);
    std::fs::write(&path, json.to_string()).unwrap();
}

#[test]
fn the_same_asset_passes_exactly() {
    let (asset, directory) = (ball(), tempfile::tempdir().unwrap());
    let blessed = bless_small(&asset, directory.path());
    assert_eq!(blessed.views.len(), 9);
    let verdict = check(&asset, directory.path(), Some(0.0), &mut reference(&asset)).unwrap();
    assert!(verdict.passed(), "{}", verdict.text());
    assert_eq!(verdict.text().lines().filter(|line| line.starts_with("passed")).count(), 9);
}

#[test]
fn one_changed_number_fails_and_the_page_shows_where() {
    let (asset, directory) = (ball(), tempfile::tempdir().unwrap());
    let golden = directory.path().join("golden");
    bless_small(&asset, &golden);
    let changes: [(&str, fn(&mut Splat)); 4] = [
        ("curvature", |splat| splat.curvature.x *= 1.3),
        ("radius", |splat| splat.radii.y *= 3.0),
        ("center", |splat| splat.center *= 1.02),
        ("axes", |splat| splat.axes *= DMat3::from_rotation_x(0.1)),
    ];
    for (name, change) in changes {
        let mut changed = asset.clone();
        change(&mut changed.splats[17]);
        let verdict = check(&changed, &golden, None, &mut reference(&changed)).unwrap();
        assert!(!verdict.passed(), "{name}\n{}", verdict.text());
        let page = directory.path().join(name);
        let page = write_evidence(&verdict, Path::new("ball.qsplat"), &golden, &page).unwrap();
        let html = std::fs::read_to_string(&page).unwrap();
        assert!(html.contains("FAILED") && html.contains("ball.qsplat") && html.contains("<i style="));
        for suffix in ["input", "golden", "difference", "heat"] {
            let file = format!("iso-normals-{suffix}.png");
            assert!(html.contains(&file), "{file} is not on the page");
            let picture = image::open(page.with_file_name(&file)).unwrap();
            assert_eq!((picture.width(), picture.height()), (144, 144), "{file}");
        }
    }
}

#[test]
fn one_sample_that_another_renderer_rounds_apart_passes() {
    let (asset, directory) = (ball(), tempfile::tempdir().unwrap());
    bless_small(&asset, directory.path());
    let mut draw = reference(&asset);
    let mut one_apart = |camera: &Camera, settings: &Settings| {
        let mut picture = draw(camera, settings)?;
        if settings.show == Show::Normals {
            let [x, y] = settings.size.map(|side| side / 2);
            let farthest = picture.get_pixel(x, y).0.map(|byte| if byte > 127 { 0 } else { 255 });
            picture.put_pixel(x, y, image::Rgb(farthest));
        }
        Ok(picture)
    };
    let verdict = check(&asset, directory.path(), None, &mut one_apart).unwrap();
    assert!(verdict.passed(), "{}", verdict.text());
    assert!(verdict.views.iter().any(|view| view.scores.block.mean > 0.0), "the sample was turned");
}

#[test]
fn broken_promises_fail_though_the_pictures_agree() {
    let (mut asset, directory) = (ball(), tempfile::tempdir().unwrap());
    bless_small(&asset, directory.path());
    asset.fit.max = 2.0 * asset.max_error;
    let verdict = check(&asset, directory.path(), None, &mut reference(&asset)).unwrap();
    assert!(!verdict.passed() && verdict.text().contains("above the stored bound"), "{}", verdict.text());
    asset.fit.max = f64::NAN;
    assert!(!promises(&asset).is_empty());
    asset.splats.clear();
    assert!(promises(&asset).iter().any(|promise| promise.contains("no splats")));
}

#[test]
fn blessing_keeps_views_and_limits_made_by_hand() {
    let (asset, directory) = (ball(), tempfile::tempdir().unwrap());
    let directory = directory.path();
    bless_small(&asset, directory);
    edit(directory, |json| {
        json["size"] = serde_json::json!([40, 30]);
        json["limits"]["flip_mean"] = serde_json::json!(0.125);
        json["views"].as_array_mut().unwrap().truncate(2);
    });
    let stale = check(&asset, directory, None, &mut reference(&asset)).unwrap_err().to_string();
    assert!(stale.contains("front.png") && stale.contains("--bless"), "{stale}");
    let blessed = bless(&asset, directory, None, &mut reference(&asset)).unwrap();
    assert_eq!((blessed.size, blessed.views.len()), ([40, 30], 2));
    assert!((blessed.limits.flip_mean - 0.125).abs() < 1e-15);
    assert!(check(&asset, directory, None, &mut reference(&asset)).unwrap().passed());
}

#[test]
fn broken_goldens_are_refused_by_name() {
    let (asset, directory) = (ball(), tempfile::tempdir().unwrap());
    let directory = directory.path();
    let refusal = || check(&asset, directory, None, &mut reference(&asset)).unwrap_err().to_string();
    assert!(refusal().contains("--bless"));
    bless_small(&asset, directory);
    let sound = std::fs::read_to_string(directory.join(golden::FILE)).unwrap();
    let changes: [(&str, fn(&mut serde_json::Value)); 6] = [
        ("schema", |json| json["schema"] = "qsplat-golden/9".into()),
        ("../x", |json| json["views"][0]["name"] = "../x".into()),
        ("iso", |json| json["views"][0]["name"] = "iso".into()),
        ("views", |json| json["views"] = serde_json::json!([])),
        ("limit", |json| json["limits"]["flip_block"] = serde_json::json!(1.5)),
        ("colour", |json| json["colour"] = serde_json::json!(1)),
    ];
    for (word, change) in changes {
        edit(directory, change);
        let message = refusal();
        assert!(message.contains(word) && message.contains(golden::FILE), "{word}: {message}");
        std::fs::write(directory.join(golden::FILE), &sound).unwrap();
    }
    std::fs::write(directory.join("front.png"), b"not a picture").unwrap();
    assert!(refusal().contains("front.png"));
}

#[test]
fn every_key_of_golden_json_is_documented() {
    let document = include_str!("../../docs/golden.md");
    let json = serde_json::to_value(Golden::of(&ball())).unwrap();
    let keys = |value: &serde_json::Value| value.as_object().unwrap().keys().cloned().collect::<Vec<_>>();
    let view = &json["views"][0];
    let parts = [("", keys(&json)), ("limits.", keys(&json["limits"])), ("views[].", keys(view))];
    let written =
        parts.iter().flat_map(|(prefix, keys)| keys.iter().map(move |key| format!("{prefix}{key}")));
    let mut written: Vec<String> = written.collect();
    written.extend(keys(&view["camera"]).iter().map(|key| format!("views[].camera.{key}")));
    written.sort();
    let rows = document.lines().filter_map(|line| line.strip_prefix("| `"));
    let documented = rows.filter_map(|row| row.split('`').next()).map(str::to_owned);
    // `near` is left out of a camera that does not set it.
    let mut documented: Vec<String> = documented.filter(|key| !key.ends_with(".near")).collect();
    documented.sort();
    assert_eq!(documented, written);
    let limits = golden::Limits::default();
    for limit in [limits.flip_mean, limits.flip_p99, limits.flip_block] {
        assert!(document.contains(&format!("default {limit}")), "{limit} is not the documented default");
    }
    assert!(document.contains(golden::SCHEMA));
}
