//! Feature lines as Wavefront OBJ `l` records.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::curve::Curve;

/// One `l` record a line; lines that meet share the vertex, a closed line repeats its first.
///
/// Coordinates are the shortest decimals of the mesh's 32-bit floats.
pub fn lines(lines: &[Curve]) -> Vec<u8> {
    let mut known = BTreeMap::new();
    let (mut vertices, mut records) = (String::new(), String::new());
    for line in lines {
        records.push('l');
        for point in line {
            let next = known.len() + 1;
            let index = *known.entry(point.to_array().map(f64::to_bits)).or_insert_with(|| {
                let [x, y, z] = point.as_vec3().to_array();
                // Writing to a string cannot fail.
                let _ = writeln!(vertices, "v {x} {y} {z}");
                next
            });
            let _ = write!(records, " {index}");
        }
        records.push('\n');
    }
    (vertices + &records).into_bytes()
}
