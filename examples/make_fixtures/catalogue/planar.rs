//! A flat face between outlines: a refined constrained Delaunay mesh.

use glam::DVec3;
use qsplat::{Error, Result};
use spade::{AngleLimit, ConstrainedDelaunayTriangulation, Point2, RefinementParameters, Triangulation};

use super::curve::Curve;
use super::surface::Surface;

type Delaunay = ConstrainedDelaunayTriangulation<Point2<f64>>;

/// Greatest ratio of a triangle's circumradius to its shortest edge: 1.3 is a least angle of 22.6
/// degrees, well inside what Ruppert's refinement is known to reach.
const RADIUS_TO_EDGE: f64 = 1.3;

/// Area of a triangle whose sides are one step long, less a little: refinement halves what is
/// too large, so the mean edge comes out near the step.
const AREA_PER_STEP_SQUARED: f64 = 0.6;

/// The outward normal of a face that is at right angles to an axis.
#[derive(Clone, Copy)]
pub struct Facing {
    /// 0, 1, 2 for x, y, z.
    pub axis: usize,
    /// Whether the normal points to the axis' negative side.
    pub negative: bool,
}

/// Meshes the area between closed loops in a plane; loops inside the first are holes.
///
/// The outlines keep exactly their own points.
///
/// # Errors
/// [`Error::Internal`] when outlines cross or the refinement does not end.
pub fn planar(surface: &mut Surface, loops: &[&Curve], facing: Facing, step: f64) -> Result<()> {
    let level = loops.first().and_then(|outer| outer.first()).map_or(0.0, |p| p[facing.axis]);
    let mut delaunay = constrained(loops, facing.axis)?;
    let refined = delaunay.refine(
        RefinementParameters::new()
            .keep_constraint_edges()
            .exclude_outer_faces(true)
            .with_angle_limit(AngleLimit::from_radius_to_shortest_edge_ratio(RADIUS_TO_EDGE))
            .with_max_allowed_area(AREA_PER_STEP_SQUARED * step * step),
    );
    if !refined.refinement_complete {
        return Err(Error::Internal("the refinement of a face does not end".into()));
    }
    let mut outside = vec![false; delaunay.num_all_faces()];
    for face in refined.excluded_faces {
        outside[face.index()] = true;
    }
    for face in delaunay.inner_faces().filter(|face| !outside[face.fix().index()]) {
        let corners = face.positions().map(|p| surface.vertex(lifted(p, facing.axis, level)));
        surface.triangle(corners, facing.negative);
    }
    Ok(())
}

/// The outlines' points and segments, before anything is added inside.
fn constrained(loops: &[&Curve], axis: usize) -> Result<Delaunay> {
    let mut delaunay = Delaunay::new();
    for outline in loops {
        let mut handles = Vec::with_capacity(outline.len());
        for point in *outline {
            let flat = Point2::new(point[(axis + 1) % 3], point[(axis + 2) % 3]);
            let handle = delaunay
                .insert(flat)
                .map_err(|error| Error::Internal(format!("outline {point}: {error}")))?;
            handles.push(handle);
        }
        for pair in handles.windows(2) {
            if !delaunay.can_add_constraint(pair[0], pair[1]) {
                return Err(Error::Internal("the outlines of a face cross".into()));
            }
            delaunay.add_constraint(pair[0], pair[1]);
        }
    }
    Ok(delaunay)
}

/// Back from the plane to space.
fn lifted(flat: Point2<f64>, axis: usize, level: f64) -> DVec3 {
    let mut point = DVec3::ZERO;
    point[axis] = level;
    point[(axis + 1) % 3] = flat.x;
    point[(axis + 2) % 3] = flat.y;
    point
}
