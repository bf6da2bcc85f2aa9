//! Polygons and strips to triangles.

/// How the corners of one list make triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shape {
    /// One polygon, fanned from its first corner.
    Fan,
    /// Strips of triangles, alternately oriented; -1 ends a strip.
    Strip,
}

/// Mark of a corner that is no vertex.
pub(super) const NO_VERTEX: u32 = u32::MAX;

/// What a strip ends with.
const STRIP_END: f64 = -1.0;

/// The vertex that a stored number names, or [`NO_VERTEX`].
pub(super) fn vertex(value: f64, vertices: u32) -> u32 {
    let index = value as u32;
    // Negative numbers, fractions and NaN fail one of the two.
    let whole = (0.0..f64::from(vertices)).contains(&value) && value.fract() == 0.0;
    if whole { index } else { NO_VERTEX }
}

/// Triangles of one list of stored vertex numbers.
///
/// # Errors
/// What is wrong with the list, without the place.
pub(super) fn triangulate(
    shape: Shape,
    corners: &[f64],
    vertices: u32,
    out: &mut Vec<[u32; 3]>,
) -> Result<(), String> {
    match shape {
        Shape::Fan => fan(corners, vertices, out),
        Shape::Strip => strips(corners, vertices, out),
    }
}

fn fan(corners: &[f64], vertices: u32, out: &mut Vec<[u32; 3]>) -> Result<(), String> {
    let [first, second, rest @ ..] = corners else { return Err(too_few(corners.len())) };
    if rest.is_empty() {
        return Err(too_few(corners.len()));
    }
    let first = checked(*first, vertices)?;
    let mut last = checked(*second, vertices)?;
    for &corner in rest {
        let next = checked(corner, vertices)?;
        out.push([first, last, next]);
        last = next;
    }
    Ok(())
}

fn strips(corners: &[f64], vertices: u32, out: &mut Vec<[u32; 3]>) -> Result<(), String> {
    for strip in corners.split(|corner| corner.to_bits() == STRIP_END.to_bits()) {
        let mut pair = [NO_VERTEX; 2];
        for (n, &corner) in strip.iter().enumerate() {
            let next = checked(corner, vertices)?;
            let [a, b] = pair;
            if n >= 2 {
                out.push(if n % 2 == 0 { [a, b, next] } else { [b, a, next] });
            }
            pair = [b, next];
        }
    }
    Ok(())
}

fn checked(corner: f64, vertices: u32) -> Result<u32, String> {
    match vertex(corner, vertices) {
        NO_VERTEX => Err(out_of_range(corner, vertices)),
        index => Ok(index),
    }
}

/// Message for a vertex number, counted from 0, that names no vertex.
pub(super) fn out_of_range(corner: f64, vertices: u32) -> String {
    format!("vertex index {corner} is not in 0..{vertices}; the file is damaged, export it again")
}

/// Message for a polygon that is none.
pub(super) fn too_few(corners: usize) -> String {
    format!("a face has {corners} corners, at least 3 are needed; delete the face or export again")
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn triangles(shape: Shape, corners: &[f64]) -> Result<Vec<[u32; 3]>, String> {
        let mut out = Vec::new();
        triangulate(shape, corners, 6, &mut out).map(|()| out)
    }

    #[test]
    fn polygons_are_fanned_and_strips_alternate() {
        let pentagon = triangles(Shape::Fan, &[4.0, 0.0, 1.0, 2.0, 3.0]).unwrap();
        assert_eq!(pentagon, [[4, 0, 1], [4, 1, 2], [4, 2, 3]]);
        let strips = triangles(Shape::Strip, &[0.0, 1.0, 2.0, 3.0, 4.0, -1.0, 5.0, 4.0, 3.0, -1.0]);
        assert_eq!(strips.unwrap(), [[0, 1, 2], [2, 1, 3], [2, 3, 4], [5, 4, 3]]);
    }

    #[test]
    fn what_is_no_vertex_is_refused_by_value() {
        for bad in [6.0, -1.0, 0.5, f64::NAN, 1e20] {
            let message = triangles(Shape::Fan, &[0.0, 1.0, bad]).unwrap_err();
            assert!(message.contains(&format!("vertex index {bad} is not in 0..6")), "{message}");
        }
        assert!(triangles(Shape::Strip, &[0.0, 1.0, -3.0]).is_err());
        assert!(triangles(Shape::Fan, &[0.0, 1.0]).unwrap_err().contains("2 corners"));
    }
}
