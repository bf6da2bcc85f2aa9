//! Triangles over one splat's clipped domain.

use glam::DVec2;
use spade::{ConstrainedDelaunayTriangulation, HasPosition, Point2, Triangulation};

use super::outline::{self, Tolerance};
use crate::error::{Error, Result};
use crate::model::clip_curve::Conic;
use crate::model::splat::Splat;

/// Triangles in a splat's `(u, v)` plane.
#[derive(Clone, Debug, Default)]
pub struct Patch {
    /// Vertices in model units, each within the ellipse but for rounding.
    pub points: Vec<DVec2>,
    /// Indices into `points`, counter-clockwise seen from the side that `k` points to.
    pub triangles: Vec<[u32; 3]>,
}

/// Rounds of splitting edges that are still too long. The points inside already stand close
/// enough, so that only a few near the border are left for the first rounds.
const ROUNDS: usize = 32;

/// Side of the grid of inner points, in units of the longest edge allowed: the square's
/// diagonal is then just below that length.
const GRID_PART: f64 = 0.7;

/// An axis that bends less than this share of the other (as lengths) is treated as if it bent
/// this much, so that the triangles along a cylinder's rulings are not thinner than 1 : 20.
const LEAST_STRETCH: f64 = 0.05;

/// What to do about too many triangles.
pub(super) const REMEDY: &str = "export with a larger --tolerance, or bake with a larger --max-error";

/// Vertices inside one splat, at most.
pub const POINT_LIMIT: usize = 1 << 22;

/// A vertex of the triangulation, in the stretched plane where all directions bend alike.
#[derive(Clone, Copy)]
struct Vertex(DVec2);

impl HasPosition for Vertex {
    type Scalar = f64;
    fn position(&self) -> Point2<f64> {
        // The triangulation refuses numbers below 2^-142 other than 0.
        spade::mitigate_underflow(Point2::new(self.0.x, self.0.y))
    }
}

type Plane = ConstrainedDelaunayTriangulation<Vertex>;

/// Tessellates one splat so that no triangle strays farther than `distance` from the quadric
/// and no border edge farther than that from the ellipse or the clip curve.
///
/// # Errors
/// [`Error::Usage`] if more than [`POINT_LIMIT`] vertices would be needed, or the distance is
/// not positive.
pub fn tessellate(splat: &Splat, distance: f64) -> Result<Patch> {
    let positive = distance > 0.0 && distance.is_finite();
    if !positive {
        return Err(Error::Usage(format!(
            "cannot tessellate to a distance of {distance}: it must be positive"
        )));
    }
    let sheet = Sheet::new(splat, Tolerance::of_distance(distance));
    let mut plane = Plane::new();
    sheet.insert_outline(&mut plane)?;
    sheet.insert_grid(&mut plane)?;
    sheet.split_long_edges(&mut plane)?;
    Ok(sheet.kept(&plane))
}

/// A splat, its domain and the stretched plane.
struct Sheet<'a> {
    splat: &'a Splat,
    conics: Vec<Conic>,
    tolerance: Tolerance,
    /// Stretched coordinates are `uv * stretch`.
    stretch: DVec2,
    /// Side of the grid of inner points, stretched; infinite for a flat splat.
    step: f64,
}

impl<'a> Sheet<'a> {
    fn new(splat: &'a Splat, tolerance: Tolerance) -> Self {
        let conics = splat.conics();
        let sagitta = (splat.curvature * splat.radii * splat.radii).abs();
        let greatest = sagitta.max_element();
        let (part, step) = if greatest > 0.0 {
            let part = DVec2::new(libm::sqrt(sagitta.x / greatest), libm::sqrt(sagitta.y / greatest));
            // |a du² + b dv²| is at most `greatest` times the squared stretched length.
            (part.max(DVec2::splat(LEAST_STRETCH)), GRID_PART * libm::sqrt(tolerance.bend / greatest))
        } else {
            (DVec2::ONE, f64::INFINITY)
        };
        Self { splat, conics, tolerance, stretch: part / splat.radii, step }
    }

    fn covers(&self, uv: DVec2) -> bool {
        self.splat.ellipse(uv) <= 1.0 && !self.conics.iter().any(|conic| conic.cuts(uv))
    }

    fn insert_outline(&self, plane: &mut Plane) -> Result<()> {
        let mut border = outline::ellipse(self.splat, &self.conics, self.tolerance);
        border.extend(border.first().copied());
        self.insert_chain(plane, &border)?;
        for conic in &self.conics {
            self.insert_chain(plane, &outline::clip_curve(self.splat, conic, self.tolerance))?;
        }
        Ok(())
    }

    /// Chains that cross are cut at the crossing.
    fn insert_chain(&self, plane: &mut Plane, chain: &[DVec2]) -> Result<()> {
        let mut last = None;
        for &point in chain {
            let next = plane.insert(Vertex(point * self.stretch)).map_err(refused)?;
            if let Some(last) = last.filter(|&last| last != next) {
                plane.add_constraint_and_split(last, next, |p| Vertex(DVec2::new(p.x, p.y)));
            }
            last = Some(next);
        }
        Ok(())
    }

    fn insert_grid(&self, plane: &mut Plane) -> Result<()> {
        if self.step.is_infinite() {
            return Ok(());
        }
        let count = (self.splat.radii * self.stretch / self.step).floor();
        let few = (2.0 * count.x + 1.0) * (2.0 * count.y + 1.0) <= POINT_LIMIT as f64;
        if !few {
            return Err(too_many());
        }
        let range = |n: f64| (-(n as i64)..=n as i64).map(move |k| k as f64 * self.step);
        for x in range(count.x) {
            for y in range(count.y) {
                let at = DVec2::new(x, y);
                if self.covers(at / self.stretch) {
                    plane.insert(Vertex(at)).map_err(refused)?;
                }
            }
        }
        Ok(())
    }

    /// Splits edges inside until each keeps the bend. Edges of the outline keep it already.
    fn split_long_edges(&self, plane: &mut Plane) -> Result<()> {
        for _ in 0..ROUNDS {
            let middles = self.middles_of_long_edges(plane);
            if middles.is_empty() {
                return Ok(());
            }
            if plane.num_vertices() + middles.len() > POINT_LIMIT {
                return Err(too_many());
            }
            for middle in middles {
                plane.insert(Vertex(middle)).map_err(refused)?;
            }
        }
        Err(Error::Internal(format!("the tessellation of a splat did not settle in {ROUNDS} rounds")))
    }

    fn middles_of_long_edges(&self, plane: &Plane) -> Vec<DVec2> {
        let long = plane.undirected_edges().filter(|edge| !edge.is_constraint_edge()).filter_map(|edge| {
            let [from, to] = edge.vertices().map(|v| v.data().0);
            let middle = from.midpoint(to);
            let long = outline::bend(self.splat, (to - from) / self.stretch) > self.tolerance.bend;
            (long && self.covers(middle / self.stretch)).then_some(middle)
        });
        long.collect()
    }

    /// The triangles whose middle is covered, with the vertices they use.
    fn kept(&self, plane: &Plane) -> Patch {
        let mut patch = Patch::default();
        let mut number = vec![u32::MAX; plane.num_vertices()];
        for face in plane.inner_faces() {
            let corners = face.vertices();
            let middle = corners.iter().map(|v| v.data().0).sum::<DVec2>() / 3.0;
            if !self.covers(middle / self.stretch) {
                continue;
            }
            patch.triangles.push(corners.map(|corner| {
                let slot = &mut number[corner.fix().index()];
                if *slot == u32::MAX {
                    *slot = patch.points.len() as u32;
                    patch.points.push(corner.data().0 / self.stretch);
                }
                *slot
            }));
        }
        patch
    }
}

fn refused(error: spade::InsertionError) -> Error {
    Error::Internal(format!("the tessellation refused a vertex: {error}"))
}

fn too_many() -> Error {
    let what =
        format!("one splat alone would need more than {POINT_LIMIT} vertices to stay within the tolerance");
    Error::Usage(format!("{what}; {REMEDY}"))
}
