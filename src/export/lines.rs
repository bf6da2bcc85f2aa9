//! Feature lines as an OBJ.

use std::fmt::Write as _;

use crate::model::polyline::{Polylines, is_closed};

/// An OBJ of polylines: `v` and `l` records. Coordinates read back as they are; a line that closes
/// names its first point again.
#[must_use]
pub fn obj(lines: &Polylines) -> String {
    let mut text = String::from("# feature lines, by qsplat\n");
    let mut records = String::new();
    let mut next = 1;
    for line in &lines.lines {
        let closed = is_closed(line);
        let points = if closed { &line[..line.len() - 1] } else { &line[..] };
        for p in points {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
        }
        let numbers = (next..next + points.len()).chain(closed.then_some(next));
        let numbers: Vec<String> = numbers.map(|n| n.to_string()).collect();
        let _ = writeln!(records, "l {}", numbers.join(" "));
        next += points.len();
    }
    text + &records
}
