//! Wavefront OBJ: polygons, polylines and points.
//!
//! The line parser is our own. The faults of the crate `tobj` carry neither line nor value, it
//! panics on a short colour in a material library, and it does not read UTF-16.

mod corner;
mod normals;
mod records;

use glam::DVec3;

use super::assemble::Geometry;
use super::positions::Positions;
use super::source::Source;
use crate::error::Result;
use crate::model::polyline::Polylines;
use records::Records;

/// Reads points and faces.
pub(super) fn read(source: &Source) -> Result<Geometry<'static>> {
    let records = Records::read(source)?;
    if records.triangles.is_empty() && !records.lines.is_empty() {
        return Err(source.whole(
            "holds polylines and no faces: pass it as feature lines, or add the `f` records of the surface",
        ));
    }
    let normals = records.corner_normals.of_vertices(&records.normals, records.positions.len());
    let triangles = Some(records.triangles).filter(|triangles| !triangles.is_empty());
    let positions = Positions::Stored(records.positions);
    Ok(Geometry { positions, normals, colors: records.colors, triangles })
}

/// Reads the `l` records.
pub(super) fn read_edges(source: &Source) -> Result<Polylines> {
    let records = Records::read(source)?;
    if records.lines.is_empty() {
        return Err(
            source.whole("has no `l` record, so there are no feature lines; export them as polylines")
        );
    }
    let mut lines = Vec::with_capacity(records.lines.len());
    for (offset, corners) in &records.lines {
        let points: Vec<DVec3> = corners.iter().map(|&v| records.positions[v as usize]).collect();
        if let Some(point) = points.iter().find(|point| !point.is_finite()) {
            let what = format!("the polyline has a point at {point}, which is not finite; remove it");
            return Err(source.at_line(*offset, what));
        }
        lines.push(points);
    }
    Ok(Polylines { lines })
}
