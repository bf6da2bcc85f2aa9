//! Bakes that do without quadrics or without curved cuts, for comparison: they keep every
//! guarantee and cost more splats.

use qsplat::bake::{Clips, MaxError, Options, Shapes};
use qsplat::model::asset::Asset;
use qsplat::model::clip_curve::ClipCurve;
use qsplat::model::splat::Kind;

use super::{BUDGETS, COARSER, RIM, SIDE, backward, bake, bake_as, distance, mesh, slope, views};

/// Shares of the pixels that rays along which no bake looks may see through: slits between planes that are
/// narrower than its lattice of rays, where a surface is seen at its flattest.
const SLITS: f64 = 1e-6;

fn limited(name: &str, share: f64, shapes: Shapes, clips: Clips) -> Asset {
    let mesh = mesh(name);
    let max_error = MaxError::Relative(share);
    let asset = bake_as(name, &mesh, Options { max_error, shapes, clips, ..Options::default() });
    if shapes == Shapes::Flat {
        assert!(asset.splats.iter().all(|splat| splat.kind() == Kind::Flat), "{name}: a splat is curved");
    }
    if clips == Clips::Straight {
        let straight = asset.splats.iter().flat_map(|splat| &splat.clips).all(ClipCurve::is_straight);
        assert!(straight, "{name}: a cut is curved");
    }
    let facets = distance::Facets::new(&mesh);
    let bound = asset.max_error * asset.frame.scale();
    let stray = backward(&asset, &|p| facets.distance(p, 4.0 * bound)) / bound;
    assert!(asset.fit.max <= asset.max_error, "{name}: the fit breaks its bound");
    assert!(stray <= RIM, "{name}: splats stray {stray:.3} bounds from the mesh");
    let [own, mut other] = [SIDE, COARSER].map(|side| views::compare(&mesh, &asset, side));
    eprintln!("{name}: {other}");
    if shapes == Shapes::Flat && other.through as f64 <= SLITS * other.compared as f64 {
        other.through = 0;
    }
    let faults = [own, other].map(|seen| seen.faults()).concat();
    assert!(faults.is_empty(), "{name}: {faults:?}");
    asset
}

#[test]
fn planes_keep_the_guarantees_and_cost_more() {
    for name in ["torus", "capped-cylinder"] {
        let flat = limited(name, BUDGETS[1], Shapes::Flat, Clips::Curved).splats.len();
        let all = bake(name, &mesh(name), BUDGETS[1]).splats.len();
        assert!(flat > 2 * all, "{name}: {flat} planes for {all} quadrics");
    }
}

#[test]
fn chords_keep_the_guarantees_and_cost_more() {
    for name in ["capped-cylinder", "plate"] {
        let straight = limited(name, BUDGETS[1], Shapes::All, Clips::Straight).splats.len();
        let curved = bake(name, &mesh(name), BUDGETS[1]).splats.len();
        assert!(straight > curved, "{name}: {straight} with chords, {curved} with conics");
    }
}

/// A disc of radius `r` on a sphere strays from its plane by `r²`: half the budget, twice the splats.
#[test]
fn planes_over_a_sphere_number_as_the_inverse_of_the_budget() {
    limited("sphere", BUDGETS[0], Shapes::Flat, Clips::Curved);
    let slope = slope("sphere", Shapes::Flat);
    assert!((slope + 1.0).abs() <= 0.15, "slope {slope:.2}");
}
