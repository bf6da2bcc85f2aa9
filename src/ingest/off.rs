//! OFF: the Object File Format of Geomview, as text, with colours and normals.

use glam::{DVec3, Vec3};

use super::assemble::Geometry;
use super::color;
use super::faces::{self, Shape};
use super::positions::Positions;
use super::source::Source;
use super::text::{self, Line};
use crate::error::{Error, Result};

/// Fewest bytes of a vertex (three digits and their separators) and of a face (its count).
const LEAST_VERTEX: u64 = 6;
const LEAST_FACE: u64 = 2;

/// What the first word says of a vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Layout {
    texture: bool,
    colors: bool,
    normals: bool,
}

/// Reads points and faces.
pub(super) fn read(source: &Source) -> Result<Geometry<'static>> {
    let mut lines = text::lines(&source.bytes, 0).map(without_comment).filter(|line| !line.bytes.is_empty());
    let Some(first) = lines.next() else { return Err(source.whole("holds comments only; export it again")) };
    let (layout, rest) = parse_first(source, first)?;
    let counts = if rest.bytes.is_empty() { lines.next() } else { Some(rest) };
    let (vertices, faces) = parse_counts(source, counts)?;

    let mut columns = Vertices::default();
    for row in 0..vertices {
        let Some(line) = lines.next() else {
            return Err(cut_short(source, "vertices", row.into(), vertices.into()));
        };
        columns.push(source, line, layout)?;
    }
    let mut triangles = Vec::new();
    for row in 0..faces {
        let Some(line) = lines.next() else { return Err(cut_short(source, "faces", row, faces)) };
        face(source, line, vertices, &mut triangles)?;
    }
    Ok(Geometry {
        positions: Positions::Stored(columns.positions),
        normals: columns.normals,
        colors: columns.colors.levels(),
        triangles: (faces > 0).then_some(triangles),
    })
}

fn without_comment(line: Line) -> Line {
    let bytes = line.bytes.split(|&byte| byte == b'#').next().unwrap_or_default();
    Line { offset: line.offset, bytes: bytes.trim_ascii() }
}

/// The layout and what follows the first word on its line. The word may be left out.
fn parse_first<'a>(source: &Source, line: Line<'a>) -> Result<(Layout, Line<'a>)> {
    let word = text::tokens(line.bytes).next().unwrap_or_default();
    let Some(mut prefix) = word.strip_suffix(b"OFF") else { return Ok((Layout::default(), line)) };
    let rest = Line { offset: line.offset, bytes: line.bytes[word.len()..].trim_ascii() };
    let mut layout = Layout::default();
    let mut flag = |name: &[u8]| {
        let found = prefix.strip_prefix(name);
        prefix = found.unwrap_or(prefix);
        found.is_some()
    };
    layout.texture = flag(b"ST");
    layout.colors = flag(b"C");
    layout.normals = flag(b"N");
    if !prefix.is_empty() || rest.bytes.starts_with(b"BINARY") {
        let what = format!(
            "{} is an OFF variant that is not read (binary, or not of three dimensions); convert it to PLY, \
             OBJ or plain OFF",
            text::quote(line.bytes)
        );
        return Err(source.at_line(line.offset, what));
    }
    Ok((layout, rest))
}

/// The numbers of vertices and faces, held against the size of the file.
fn parse_counts(source: &Source, line: Option<Line>) -> Result<(u32, u64)> {
    let Some(line) = line else {
        return Err(source.whole("ends before the line of counts; export it again"));
    };
    let words: Vec<&[u8]> = text::tokens(line.bytes).collect();
    let counts: Vec<u64> = words
        .iter()
        .filter_map(|word| text::integer(word).and_then(|count| u64::try_from(count).ok()))
        .collect();
    let [vertices, faces, _] = counts[..] else {
        let what = format!(
            "{} is no line of counts (vertices, faces, edges); correct it or export the file again",
            text::quote(line.bytes)
        );
        return Err(source.at_line(line.offset, what));
    };
    let need = vertices.saturating_mul(LEAST_VERTEX).saturating_add(faces.saturating_mul(LEAST_FACE));
    // The last number of the file needs no separator after it.
    let left = (source.bytes.len() - line.offset) as u64 + 1;
    if need > left {
        let what = format!(
            "{vertices} vertices and {faces} faces need at least {need} bytes, and {left} are left; the file \
             is cut short or the line damaged, export it again"
        );
        return Err(source.at_line(line.offset, what));
    }
    source.check_points(vertices)?;
    source.check_triangles(faces)?;
    let vertices =
        u32::try_from(vertices).map_err(|_| Error::Internal("point limit above 32 bits".into()))?;
    Ok((vertices, faces))
}

/// The columns of the vertices.
#[derive(Default)]
struct Vertices {
    positions: Vec<DVec3>,
    normals: Vec<Vec3>,
    colors: Colors,
}

impl Vertices {
    /// Position, then normal, colour and texture coordinates as far as the layout has them.
    fn push(&mut self, source: &Source, line: Line, layout: Layout) -> Result<()> {
        let words: Vec<&[u8]> = text::tokens(line.bytes).collect();
        let normals = if layout.normals { 3 } else { 0 };
        let texture = if layout.texture { 2 } else { 0 };
        let color = words.len().checked_sub(3 + normals + texture);
        if !matches!((layout.colors, color), (true, Some(3 | 4)) | (false, Some(0))) {
            let what = format!(
                "a vertex has {} numbers, which does not fit the first word of the file; correct the line or \
                 export the file again",
                words.len()
            );
            return Err(source.at_line(line.offset, what));
        }
        self.positions.push(triple(source, line, &words)?);
        if layout.normals {
            self.normals.push(triple(source, line, &words[3..])?.as_vec3());
        }
        if layout.colors {
            let words = &words[3 + normals..];
            let whole = words[..3].iter().all(|word| text::integer(word).is_some());
            self.colors.push(triple(source, line, words)?, whole);
        }
        Ok(())
    }
}

fn triple(source: &Source, line: Line, words: &[&[u8]]) -> Result<DVec3> {
    let mut values = [0.0; 3];
    for (value, word) in values.iter_mut().zip(words) {
        *value = number(source, line, word)?;
    }
    Ok(DVec3::from_array(values))
}

fn number(source: &Source, line: Line, word: &[u8]) -> Result<f64> {
    text::number(word).ok_or_else(|| {
        let what = format!("{} is no number; correct the line or export the file again", text::quote(word));
        source.at_line(line.offset, what)
    })
}

/// A count, so many indices, and perhaps a colour of the face, which is not read.
fn face(source: &Source, line: Line, vertices: u32, triangles: &mut Vec<[u32; 3]>) -> Result<()> {
    let mut words = text::tokens(line.bytes);
    let word = words.next().unwrap_or_default();
    let count = text::integer(word).and_then(|count| usize::try_from(count).ok());
    let Some(count) = count else {
        let what = format!(
            "{} is no number of corners; correct the line or export the file again",
            text::quote(word)
        );
        return Err(source.at_line(line.offset, what));
    };
    let corners = words.take(count).map(|word| number(source, line, word)).collect::<Result<Vec<_>>>()?;
    if corners.len() < count {
        let what = format!(
            "a face has {} of its {count} corners; correct the line or export the file again",
            corners.len()
        );
        return Err(source.at_line(line.offset, what));
    }
    source.check_triangles((triangles.len() + count.saturating_sub(2)) as u64)?;
    faces::triangulate(Shape::Fan, &corners, vertices, triangles)
        .map_err(|what| source.at_line(line.offset, what))
}

fn cut_short(source: &Source, unit: &str, found: u64, count: u64) -> Error {
    let what = format!("has {found} of its {count} {unit}; the file is cut short, export or copy it again");
    source.at_line(source.bytes.len(), what)
}

/// Colours as stored: 0 to 255 where the whole file has whole numbers, else 0 to 1.
#[derive(Default)]
struct Colors {
    stored: Vec<Vec3>,
    fractions: bool,
}

impl Colors {
    fn push(&mut self, color: DVec3, whole: bool) {
        self.stored.push(color.as_vec3());
        self.fractions |= !whole;
    }

    fn levels(self) -> Vec<[u8; 3]> {
        let scale = if self.fractions { 255.0 } else { 1.0 };
        let levels = |color: Vec3| color.to_array().map(|channel| color::level(scale * f64::from(channel)));
        self.stored.into_iter().map(levels).collect()
    }
}
