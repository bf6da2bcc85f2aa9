//! Holes: the input and the splats seen from the 26 directions of the cube, pixel by pixel.

use std::fmt;

use glam::DVec3;
use qsplat::model::asset::Asset;
use qsplat::model::mesh::Mesh;
use qsplat::render::camera::Projection;
use qsplat::render::input::{self, Model, Style};
use qsplat::render::{Camera, cpu};

/// Pixels a side.
const SIDE: u32 = 256;

/// Bounds by which the nearest splat may lie behind the input before it counts as seen through.
const BEHIND: f64 = 4.0;

/// What 26 views showed, in pixels.
#[derive(Default)]
pub struct Seen {
    compared: usize,
    missing: usize,
    extra: usize,
    through: usize,
}

impl Seen {
    /// What breaks a promise, if so many pixels may be seen through.
    pub fn faults(&self, through: usize) -> Vec<String> {
        let mut faults = Vec::new();
        let through = self.through.saturating_sub(through);
        for (what, count) in [("missing", self.missing), ("extra", self.extra), ("seen through", through)] {
            if count > 0 {
                faults.push(format!("{count} of {} pixels are {what}", self.compared));
            }
        }
        faults
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

/// The directions from the middle of a cube to its faces, edges and corners.
fn directions() -> impl Iterator<Item = DVec3> {
    let steps = [-1.0, 0.0, 1.0];
    let all = steps.into_iter().flat_map(move |x| {
        steps.into_iter().flat_map(move |y| steps.into_iter().map(move |z| DVec3::new(x, y, z)))
    });
    all.filter(|d| *d != DVec3::ZERO).map(DVec3::normalize)
}

/// Compares a bake with its input.
///
/// A pixel counts where the input's hits agree over the three by three pixels around it, so not
/// along the silhouette. It is *seen through* where the splats lie farther behind than all that
/// the input shows in those nine pixels: a hole in a closed surface shows its far side.
pub fn compare(mesh: &Mesh, asset: &Asset) -> Seen {
    let mut seen = Seen::default();
    let size = asset.diagonal * asset.frame.scale();
    for direction in directions() {
        let up = if direction.z.abs() > 0.9 { DVec3::Y } else { DVec3::Z };
        let camera = Camera {
            eye: (asset.frame.origin + size * direction).into(),
            target: asset.frame.origin.into(),
            up: up.into(),
            projection: Projection::Orthographic { height: 1.02 * size },
            near: None,
        };
        let picture = [SIDE, SIDE];
        let splats = cpu::visibility(asset, &camera, picture).unwrap();
        let input = input::visibility(Model::Mesh(mesh), &camera, picture, &Style::default()).unwrap();
        for y in 1..SIDE - 1 {
            for x in 1..SIDE - 1 {
                let around: Vec<Option<f64>> =
                    (0..9).map(|n| input.at(x + n % 3 - 1, y + n / 3 - 1).map(|hit| hit.depth)).collect();
                if around.iter().any(|depth| depth.is_some() != around[4].is_some()) {
                    continue;
                }
                seen.compared += 1;
                let farthest = around.iter().flatten().copied().reduce(f64::max);
                match (farthest, splats.at(x, y)) {
                    (Some(_), None) => seen.missing += 1,
                    (None, Some(_)) => seen.extra += 1,
                    (Some(far), Some(hit)) if hit.depth > far + BEHIND * asset.max_error => seen.through += 1,
                    _ => {}
                }
            }
        }
    }
    seen
}
