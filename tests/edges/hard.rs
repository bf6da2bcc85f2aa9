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

/// Bakes a shape; its faults.
fn check(Shape { name, input, edges }: Shape) -> Vec<String> {
    let Input::Mesh(mesh) = &input else { panic!("{name} is a mesh") };
    let max_error = MaxError::Relative(BOUND);
    let (delivery, found) = measured(&input, &Options { max_error, edges, ..Options::default() });
    assert!(found.has_edge(), "{name}: no line was followed");
    let seen = views::compare(mesh, &delivery.asset, SIDE);
    eprintln!("{name}: {found}\n    {seen}");
    let faults = found.faults().into_iter().chain(seen.faults());
    faults.map(|fault| format!("{name}: {fault}")).collect()
}

#[test]
fn lines_that_one_curve_cannot_follow_keep_every_bound() {
    let faults: Vec<String> = shapes::all().into_iter().flat_map(check).collect();
    assert!(faults.is_empty(), "\n{}\n", faults.join("\n"));
}
