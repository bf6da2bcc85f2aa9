//! What the file promises, tried on planted and adversarial splats.

use glam::{DVec2, DVec3};

use super::planted::{Random, asset, bumpy_asset, curve, frame, on_bumpy};
use super::quantize::{Quantizer, radius_below};
use super::{Limits, decode, encode, inspect, snap};
use crate::model::asset::{Accuracy, Asset};
use crate::model::splat::Splat;
use crate::tolerance::{CLIP_QUANTIZE_SHARE, FIT_SHARE, QUANTIZE_SHARE};

/// A splat with numbers drawn far beyond what a bake makes: needles, steep bowls, tiny discs.
fn wild(random: &mut Random, e: f64) -> Splat {
    let large = e * libm::exp2(random.within(-3.0, 9.0));
    let ratio = if random.unit() < 0.3 { 1.0 } else { libm::exp2(-random.within(0.0, 10.0)) };
    let radii = DVec2::new(large, (large * ratio).max(e / 16.0));
    let slope =
        |random: &mut Random| random.within(-1.0, 1.0) * [0.0, 0.1, 1.0, 4.0][random.bits() as usize % 4];
    let curvature = 0.5 * DVec2::new(slope(random), slope(random)) / radii;
    let k = match random.bits() % 4 {
        0 => DVec3::AXES[random.bits() as usize % 3] * if random.unit() < 0.5 { -1.0 } else { 1.0 },
        1 => (DVec3::ONE + random.direction() * 1e-6).normalize(),
        _ => random.direction(),
    };
    Splat {
        center: random.direction() * random.within(0.0, 1.7),
        axes: frame(k, random),
        radii,
        curvature,
        clips: Vec::new(),
        partners: Vec::new(),
        color: [255; 3],
    }
}

/// The share of the budget that rounding uses at sampled points of the domain, and the largest
/// value of the rounded ellipse there.
fn worst_of(splat: &Splat, snapped: &Splat, e: f64, random: &mut Random) -> (f64, f64) {
    let (mut height, mut reach) = (0.0_f64, 0.0_f64);
    for n in 0..200 {
        let radius = if n < 100 { 1.0 } else { random.unit().sqrt() };
        let (sin, cos) = libm::sincos(random.within(0.0, std::f64::consts::TAU));
        let uv = splat.radii * DVec2::new(cos, sin) * radius;
        for off in [0.0, -FIT_SHARE * e, FIT_SHARE * e] {
            let point = splat.surface_point(uv) + splat.axes.z_axis * off;
            let local = snapped.to_local(point);
            let now = (local.z - snapped.height(local.truncate())).abs();
            height = height.max((now - off.abs()) / e);
            if off == 0.0 {
                reach = reach.max(snapped.ellipse(local.truncate()));
            }
        }
    }
    (height, reach)
}

#[test]
fn the_surface_moves_less_than_its_share() {
    let (mut random, mut worst, mut farthest, mut sum) = (Random(11), 0.0_f64, 0.0_f64, 0.0);
    let count = 20_000;
    for n in 0..count {
        let e = libm::exp2(-random.within(6.0, 20.0));
        let splat = if n % 2 == 0 {
            on_bumpy(random.direction(), e, random.within(5.0, 60.0))
        } else {
            wild(&mut random, e)
        };
        let snapped = Quantizer::new(e).snap(&splat).unwrap();
        let (height, reach) = worst_of(&splat, &snapped, e, &mut random);
        assert!(height <= QUANTIZE_SHARE && reach <= 1.0 + 1e-9, "{height} {reach} {splat:?} {snapped:?}");
        (worst, farthest, sum) = (worst.max(height), farthest.max(reach), sum + height);
    }
    println!(
        "height moved, in budgets: worst {worst:.4}, mean {:.4}; reach {farthest:.12}",
        sum / f64::from(count)
    );
    // The bound is sharp enough to be worth having.
    assert!(worst > 0.5 * QUANTIZE_SHARE);
}

#[test]
fn what_comes_out_goes_in_unchanged() {
    let (mut random, e) = (Random(5), 1e-3);
    let mut splats: Vec<_> = (0..5000).map(|_| wild(&mut random, e)).collect();
    for splat in &mut splats {
        for _ in 0..random.bits() % 4 {
            splat.clips.push(curve(splat.radii, &mut random));
        }
        splat.color = [random.bits() as u8, random.bits() as u8, 9];
    }
    let made = Asset { has_colors: true, ..asset(splats, e) };
    let bytes = encode(&made).unwrap();
    let back = decode(&bytes, &Limits::default()).unwrap();
    assert_eq!(encode(&back).unwrap(), bytes);
    assert_eq!(snap(&made).unwrap(), back);
    assert_eq!(snap(&back).unwrap(), back);
    let counts = back.counts();
    println!("{counts:?}, {} bytes", bytes.len());
    assert!(
        counts.flat > 500 && counts.quadric > 500 && counts.curved_clips > 500 && counts.straight_clips > 500
    );
    for splat in &back.splats {
        let off = (splat.axes.transpose() * splat.axes - glam::DMat3::IDENTITY).to_cols_array();
        assert!(off.iter().all(|d| d.abs() < 1e-15) && splat.axes.determinant() > 0.0);
        assert!(splat.radii.x >= splat.radii.y && splat.radii.y > 0.0);
    }
}

#[test]
fn the_order_of_the_splats_does_not_matter_and_the_frame_only_moves_the_exponent() {
    let made = bumpy_asset(500, 30.0, 9);
    let bytes = encode(&made).unwrap();
    let mut mixed = made.clone();
    let mut random = Random(1);
    for n in (1..mixed.splats.len()).rev() {
        mixed.splats.swap(n, random.bits() as usize % (n + 1));
    }
    assert_eq!(encode(&mixed).unwrap(), bytes);
    let mut scaled = made;
    scaled.frame.exponent += 17;
    scaled.frame.origin *= libm::ldexp(1.0, 17);
    let other = encode(&scaled).unwrap();
    let differ = bytes.iter().zip(&other).filter(|(a, b)| a != b).count();
    // The exponent's byte and the checksum's.
    assert!(bytes.len() == other.len() && differ <= 5, "{differ}");
}

/// The greatest distance from points of one polyline to another polyline.
fn one_sided(from: &[DVec2], to: &[DVec2]) -> f64 {
    let near = |p: DVec2| {
        to.windows(2)
            .map(|s| {
                let (a, d) = (s[0], s[1] - s[0]);
                let t = if d == DVec2::ZERO {
                    0.0
                } else {
                    ((p - a).dot(d) / d.length_squared()).clamp(0.0, 1.0)
                };
                p.distance(a + d * t)
            })
            .fold(f64::INFINITY, f64::min)
    };
    from.iter().map(|p| near(*p)).fold(0.0, f64::max)
}

/// A curve a bake could fit: it stays inside between its ends, and carried on over them it
/// leads straight out, through an ellipse of radii a tenth larger, not along the border.
fn sensible(splat: &Splat, random: &mut Random) -> Option<crate::model::clip_curve::ClipCurve> {
    let clip = curve(splat.radii, random);
    let conic = clip.conic(splat.radii);
    let inside = conic.points(64).skip(1).take(63).all(|p| splat.ellipse(p) < 1.0);
    let leaves = |end: f64, step: f64| {
        let mut last = 1.0 - 1e-9;
        for n in 1..=400 {
            let now = splat.ellipse(conic.point(end + step * f64::from(n)));
            if now <= last {
                return false;
            }
            if now > 1.21 {
                return true;
            }
            last = now;
        }
        false
    };
    let steep = |end: DVec2, inner: DVec2| {
        let normal = (end / (splat.radii * splat.radii)).normalize();
        (end - inner).normalize().dot(normal) > 0.26
    };
    let (to1, to3) = if clip.is_straight() { (conic.p3, conic.p1) } else { (conic.p2, conic.p2) };
    let out = steep(conic.p1, to1) && steep(conic.p3, to3);
    let out = out && (clip.is_straight() || (leaves(0.0, -1e-3) && leaves(1.0, 1e-3)));
    (inside && out && conic.p1.distance(conic.p3) > 0.2 * splat.radii.y).then_some(clip)
}

#[test]
fn clip_curves_move_less_than_their_share() {
    let (mut random, mut worst, mut tried) = (Random(23), 0.0_f64, 0);
    while tried < 600 {
        let e = libm::exp2(-random.within(6.0, 16.0));
        let mut splat = on_bumpy(random.direction(), e, random.within(5.0, 60.0));
        if tried % 3 == 0 {
            splat.radii.y = splat.radii.x * random.within(0.01, 1.0);
        }
        let Some(clip) = sensible(&splat, &mut random) else { continue };
        splat.clips.push(clip);
        let snapped = Quantizer::new(e).snap(&splat).unwrap();
        let Some(after) = snapped.clips.first() else { continue };
        tried += 1;
        let carried: Vec<DVec2> = clip
            .conic(splat.radii)
            .points(150)
            .map(|p| snapped.to_local(splat.surface_point(p)).truncate())
            .collect();
        let curve: Vec<DVec2> = after.conic(snapped.radii).points(1200).collect();
        let there = one_sided(&carried, &curve);
        // Back only where the splat was: the curve goes on to the larger border.
        let was = |p: &DVec2| {
            let local = splat.to_local(snapped.surface_point(*p)).truncate();
            splat.ellipse(local) < 0.995
        };
        let back = one_sided(&curve.into_iter().filter(was).collect::<Vec<_>>(), &carried);
        // The polylines themselves are off by less than 1e-5 radii.
        let slack = 2e-5 * splat.radii.x;
        let share = (there.max(back) - slack) / e;
        assert!(share <= CLIP_QUANTIZE_SHARE, "{share} {there} {back} {splat:?} {snapped:?}");
        worst = worst.max(share);
    }
    println!("clip curve moved, in budgets: worst {worst:.4}");
    assert!(worst > 0.4 * CLIP_QUANTIZE_SHARE);
}

#[test]
fn each_side_of_a_clip_stays_what_it_was() {
    let (mut random, e) = (Random(31), 1e-3);
    for _ in 0..2000 {
        let mut splat = on_bumpy(random.direction(), e, random.within(10.0, 60.0));
        let Some(clip) = sensible(&splat, &mut random) else { continue };
        splat.clips.push(clip);
        let snapped = Quantizer::new(e).snap(&splat).unwrap();
        let line: Vec<DVec2> = clip.conic(splat.radii).points(300).collect();
        for _ in 0..30 {
            let uv = splat.radii * DVec2::new(random.within(-1.0, 1.0), random.within(-1.0, 1.0));
            let clear = splat.ellipse(uv) < 0.9 && one_sided(&[uv], &line) > 0.2 * e;
            if clear {
                let now = snapped.to_local(splat.surface_point(uv)).truncate();
                assert_eq!(splat.covers(uv), snapped.covers(now), "{uv} {splat:?} {snapped:?}");
            }
        }
    }
}

#[test]
fn a_bumpy_sphere_takes_few_bytes() {
    for (count, limit) in [(10, 60.0), (300, 10.0), (3000, 7.5)] {
        let made = bumpy_asset(count, 40.0, 3);
        let bytes = encode(&made).unwrap();
        let each = bytes.len() as f64 / count as f64;
        println!("{count} splats: {} bytes, {each:.2} a splat", bytes.len());
        assert!(each < limit);
        println!("  {:?}", inspect(&bytes, &Limits::default()).unwrap().fields);
    }
}

#[test]
fn kinds_that_need_less_say_less() {
    let mut made = bumpy_asset(1000, 40.0, 3);
    for splat in &mut made.splats {
        splat.curvature = DVec2::ZERO;
    }
    let flat = encode(&made).unwrap();
    for splat in &mut made.splats {
        splat.radii = DVec2::splat(splat.radii.y);
    }
    let round = encode(&made).unwrap();
    assert!(round.len() + 766 < flat.len(), "{} flat, {} flat and round", flat.len(), round.len());
    let names = |bytes: &[u8]| -> Vec<String> {
        inspect(bytes, &Limits::default()).unwrap().fields.into_iter().map(|field| field.name).collect()
    };
    let (flat, round) = (names(&flat), names(&round));
    assert!(flat.contains(&"shape".into()) && !flat.contains(&"bend".into()), "{flat:?}");
    assert_eq!(round, ["kind", "cell", "size", "norm", "place"]);
}

#[test]
fn fields_add_up_to_their_chunk() {
    let bytes = encode(&bumpy_asset(300, 40.0, 3)).unwrap();
    let info = inspect(&bytes, &Limits::default()).unwrap();
    let fields: f64 = info.fields.iter().map(|field| field.bytes).sum();
    assert_eq!((info.chunks.len(), info.chunks[0].id.as_str()), (1, "SPLT"));
    assert!((info.chunks[0].coded_bytes as f64 - fields).abs() < 2.0, "{fields}: {info:?}");
}

#[test]
fn an_empty_asset_comes_back() {
    let made = asset(Vec::new(), 1e-3);
    let bytes = encode(&made).unwrap();
    assert_eq!(decode(&bytes, &Limits::default()).unwrap(), snap(&made).unwrap());
    assert_eq!(bytes.len(), 46);
}

#[test]
fn no_achieved_error_is_understated_nor_carried_over_the_budget() {
    let mut random = Random(8);
    for n in 0..3000 {
        let e = libm::exp2(-random.within(1.0, 20.0));
        let shares = [random.unit(), f64::from(n) / 3000.0, 1.0 - random.unit() * 1e-15];
        let [rms, p99, max] = shares.map(|share| share * e);
        let made = Asset { fit: Accuracy { rms, p99, max }, ..asset(Vec::new(), e) };
        let back = decode(&encode(&made).unwrap(), &Limits::default()).unwrap();
        assert_eq!(snap(&back).unwrap(), back);
        for (said, was) in [(back.fit.rms, rms), (back.fit.p99, p99), (back.fit.max, max)] {
            assert!(said >= was && said - was <= 1.001 / 8192.0 * e && said <= e, "{said} {was} {e}");
        }
    }
    for max in [-1e-300, f64::NAN, f64::INFINITY, 1e6] {
        let made = Asset { fit: Accuracy { max, ..Accuracy::default() }, ..asset(Vec::new(), 1e-3) };
        assert!(matches!(encode(&made), Err(crate::Error::Usage(_))), "{max}");
    }
    let wide = Accuracy { max: 500.0, ..Accuracy::default() };
    let made = Asset { fit: wide, ..asset(Vec::new(), 1e-3) };
    assert_eq!(snap(&made).unwrap().fit.max, 500.0);
}

#[test]
fn what_no_file_can_hold_is_refused() {
    let e = 1e-3;
    let good = on_bumpy(DVec3::X, e, 30.0);
    let spoil: [fn(&mut Splat); 9] = [
        |s| s.center.x = f64::NAN,
        |s| s.center.y = 1e9,
        |s| s.radii.x = 0.0,
        |s| s.radii.y = f64::INFINITY,
        |s| s.radii.x = 1e9,
        |s| s.curvature.x = f64::NAN,
        |s| s.curvature.y = 1e12,
        |s| s.axes.x_axis *= 1.1,
        |s| s.axes.z_axis = -s.axes.z_axis,
    ];
    for (n, spoil) in spoil.iter().enumerate() {
        let mut splat = good.clone();
        spoil(&mut splat);
        let error = encode(&asset(vec![splat], e)).unwrap_err();
        assert!(matches!(error, crate::Error::Usage(_)), "{n}: {error}");
    }
    for (diagonal, max_error) in
        [(f64::NAN, e), (0.0, e), (2.0, 0.0), (2.0, f64::NAN), (2.0, 1e-8), (2.0, 64.0)]
    {
        let made = Asset { diagonal, max_error, ..asset(vec![good.clone()], e) };
        assert!(encode(&made).is_err(), "{diagonal} {max_error}");
    }
}

#[test]
fn chosen_radii_are_kept() {
    let mut random = Random(3);
    for _ in 0..2000 {
        let e = libm::exp2(-random.within(2.0, 20.0));
        let wanted = e * libm::exp2(random.within(-3.0, 10.0));
        let radius = radius_below(wanted, e);
        assert!(radius <= wanted && radius > wanted * 32.0 / 33.01);
        assert_eq!(radius_below(radius, e), radius);
    }
    assert_eq!(radius_below(0.01, 1.0), 0.0);
}
