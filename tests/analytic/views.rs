//! Holes: the input and the splats seen from the 26 directions of the cube, pixel by pixel.

use std::fmt;

use qsplat::measure::holes::{self, Depths, Mark};
use qsplat::measure::views;
use qsplat::model::asset::Asset;
use qsplat::model::mesh::Mesh;
use qsplat::render::cpu;
use qsplat::render::input::{Model, Prepared, Style};

/// Pixels a side: of these rays, but for 16 of a view, no bake looks along any, since it does along those of
/// [`views::SIDE`] and midway between them.
pub const COARSER: u32 = 300;

/// What 26 views showed, in pixels.
#[derive(Default)]
pub struct Seen {
    pub compared: u64,
    pub missing: u64,
    pub extra: u64,
    pub through: u64,
}

impl Seen {
    /// What breaks a promise.
    pub fn faults(&self) -> Vec<String> {
        [("missing", self.missing), ("extra", self.extra), ("seen through", self.through)]
            .into_iter()
            .filter(|&(_, count)| count > 0)
            .map(|(what, count)| format!("{count} of {} pixels are {what}", self.compared))
            .collect()
    }
}

impl fmt::Display for Seen {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} pixels compared: {} missing, {} extra, {} seen through",
            self.compared, self.missing, self.extra, self.through
        )
    }
}

/// Compares a bake with its input, in pictures of `side` pixels a side.
pub fn compare(mesh: &Mesh, asset: &Asset, side: u32) -> Seen {
    let mut seen = Seen::default();
    let input = Prepared::new(Model::Mesh(mesh), &Style::default());
    for view in views::views(Model::Mesh(mesh)) {
        let splats = cpu::visibility(asset, &view.camera, [side; 2]).unwrap();
        let own = Depths::new([side; 2], input.met(&view.camera, [side; 2]).unwrap());
        let map = holes::compare(&own, &splats, holes::behind(asset));
        seen.compared += map.compared();
        seen.missing += map.count(Mark::Missing);
        seen.extra += map.count(Mark::Extra);
        seen.through += map.count(Mark::Through);
    }
    seen
}
