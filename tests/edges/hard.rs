//! Lines that one clip curve cannot follow: split, shrunk or cut several times, the splats keep every
//! bound, and no picture shows a hole or anything beside the outline.

use qsplat::bake::{MaxError, Options};
use qsplat::ingest::Input;
use qsplat::measure::views::SIDE;

use super::measured::measured;
use super::shapes::{self, Shape};
use super::views;

/// Share of the diagonal.
const BOUND: f64 = 1e-3;

/// Pixels of all views that tips narrower than one may show beside the outline: two tips, each in two opposite
/// views.
const TIP_PIXELS: u64 = 4;

/// A facet takes at most so many splats on the average: one, but for what views ask to mend.
const SPLATS_A_FACET: usize = 2;

/// Bakes a shape; its faults, and how many splats it takes.
fn check(Shape { name, input, edges }: Shape) -> (Vec<String>, usize) {
    let Input::Mesh(mesh) = &input else { panic!("{name} is a mesh") };
    let max_error = MaxError::Relative(BOUND);
    let (delivery, found) = measured(&input, &Options { max_error, edges, ..Options::default() });
    assert!(found.has_edge(), "{name}: no line was followed");
    let mut seen = views::compare(mesh, &delivery.asset, SIDE);
    eprintln!("{name}: {found}\n    {seen}");
    if name == shapes::TIPS && seen.extra <= TIP_PIXELS {
        seen.extra = 0;
    }
    let faults = found.faults().into_iter().chain(seen.faults());
    (faults.map(|fault| format!("{name}: {fault}")).collect(), delivery.asset.splats.len())
}

#[test]
fn lines_that_one_curve_cannot_follow_keep_every_bound() {
    let faults: Vec<String> = shapes::all().into_iter().flat_map(|shape| check(shape).0).collect();
    assert!(faults.is_empty(), "\n{}\n", faults.join("\n"));
}

/// Bakes a shape of few large facets: it has no fault, and takes few splats.
fn check_facets((shape, facets): (Shape, usize)) {
    let (faults, splats) = check(shape);
    assert!(faults.is_empty(), "\n{}\n", faults.join("\n"));
    assert!(splats <= SPLATS_A_FACET * facets, "{splats} splats for {facets} facets");
}

#[test]
fn ridges_between_a_few_large_facets_are_found() {
    shapes::fans().into_iter().for_each(check_facets);
}

#[test]
fn notches_take_no_more_splats_than_facets_do() {
    check_facets(shapes::star());
}
