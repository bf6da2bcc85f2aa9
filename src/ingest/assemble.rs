//! From decoded geometry to the vocabulary's cloud or mesh.

use glam::Vec3;

use super::Input;
use super::facing::face_alike;
use super::positions::{Extent, Positions};
use super::source::Source;
use crate::error::Result;
use crate::model::frame::{EXPONENT_LIMIT, Frame};
use crate::model::{cloud::Cloud, mesh::Mesh, places};

/// Greatest half size of a bounding box: below `2^EXPONENT_LIMIT`, so that every point comes to
/// lie within `[-1, 1]`.
const BOX_LIMIT: f64 = 1e300;

/// What a reader decodes: attributes empty or one a position, indices in range.
#[derive(Debug, Default)]
pub(super) struct Geometry<'a> {
    pub positions: Positions<'a>,
    pub normals: Vec<Vec3>,
    pub colors: Vec<[u8; 3]>,
    /// `None` where the file has no faces: a cloud.
    pub triangles: Option<Vec<[u32; 3]>>,
}

/// Drops what is not finite, finds the frame and rounds to model units.
pub(super) fn assemble(source: &Source, mut geometry: Geometry) -> Result<Input> {
    let all = geometry.positions.len();
    if all == 0 {
        return Err(source.whole("holds no point; check how it was exported"));
    }
    let extent = geometry.positions.extent();
    if extent.finite == 0 {
        return Err(source.whole(format!(
            "none of its {all} points has three finite coordinates; check how it was exported"
        )));
    }
    let frame = frame(source, &extent)?;
    let faces = geometry.triangles.as_ref().map(Vec::len);
    if extent.finite < all {
        geometry = without_broken_points(geometry);
    }
    let vertices = Cloud {
        frame,
        positions: geometry.positions.to_model(frame),
        normals: geometry.normals,
        colors: geometry.colors,
        dropped: all - extent.finite,
    };
    let Some(mut triangles) = geometry.triangles else { return Ok(Input::Cloud(vertices)) };
    let (places, _) = places::numbered(&vertices.positions);
    triangles.retain(|&triangle| is_triangle(triangle.map(|v| places[v as usize])));
    let dropped = faces.unwrap_or(0) - triangles.len();
    if triangles.is_empty() {
        return Err(source.whole(format!(
            "none of its {dropped} triangles has three different corners with finite coordinates; \
             mend the faces or delete them to use the points as a cloud"
        )));
    }
    let turned = face_alike(&vertices.positions, &places, &mut triangles);
    Ok(Input::Mesh(Mesh { vertices, triangles, dropped, turned }))
}

/// Whether a triangle has three corners.
fn is_triangle([a, b, c]: [u32; 3]) -> bool {
    a != b && b != c && c != a
}

fn frame(source: &Source, extent: &Extent) -> Result<Frame> {
    // Which of 0 and -0 a minimum keeps depends on the order; adding 0 makes both 0.
    let (min, max) = (extent.min + 0.0, extent.max + 0.0);
    let size = (0.5 * max - 0.5 * min).max_element();
    let least = libm::ldexp(1.0, -EXPONENT_LIMIT);
    if size > BOX_LIMIT || (size > 0.0 && size < least) {
        return Err(source.whole(format!(
            "the bounding box reaches from {min} to {max}, beyond what can be scaled; change the \
             unit or remove the outliers"
        )));
    }
    Ok(Frame::of_box(min, max))
}

/// Leaves out the points that are not finite and the triangles that use them.
fn without_broken_points(mut geometry: Geometry) -> Geometry {
    const DROPPED: u32 = u32::MAX;
    let mut positions = geometry.positions.into_stored();
    let mut kept = 0;
    let renumber = positions.iter().map(|point| {
        let number = if point.is_finite() { kept } else { DROPPED };
        kept += u32::from(point.is_finite());
        number
    });
    let renumbered: Vec<u32> = renumber.collect();
    keep_marked(&mut positions, &renumbered, DROPPED);
    keep_marked(&mut geometry.normals, &renumbered, DROPPED);
    keep_marked(&mut geometry.colors, &renumbered, DROPPED);
    if let Some(triangles) = &mut geometry.triangles {
        triangles.retain_mut(|triangle| {
            *triangle = triangle.map(|v| renumbered[v as usize]);
            !triangle.contains(&DROPPED)
        });
    }
    Geometry { positions: Positions::Stored(positions), ..geometry }
}

fn keep_marked<T>(values: &mut Vec<T>, marks: &[u32], dropped: u32) {
    let mut mark = marks.iter();
    values.retain(|_| mark.next().is_some_and(|&mark| mark != dropped));
}
