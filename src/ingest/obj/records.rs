//! The records of an OBJ file that matter: `v`, `vn`, `vt` (counted), `f` and `l`.

use glam::{DVec3, Vec3};

use super::super::color;
use super::super::faces;
use super::super::source::Source;
use super::super::text;
use super::corner::{Corner, Counts, Indices};
use super::normals::CornerNormals;
use crate::error::{Error, Result};

/// Most numbers that a record may have.
const NUMBERS: usize = 8;

pub(super) struct Records<'a> {
    source: &'a Source<'a>,
    pub positions: Vec<DVec3>,
    /// Empty until a vertex has a colour.
    pub colors: Vec<[u8; 3]>,
    texture_coordinates: u64,
    pub normals: Vec<Vec3>,
    pub triangles: Vec<[u32; 3]>,
    pub corner_normals: CornerNormals,
    /// Offset and vertices of each polyline.
    pub lines: Vec<(usize, Vec<u32>)>,
    indices: Indices,
}

impl<'a> Records<'a> {
    /// Reads the file; where it is at fault a second time, to find the first line at fault.
    pub fn read(source: &'a Source<'a>) -> Result<Self> {
        match Self::pass(source, None) {
            Ok(records) if records.is_whole() => return Ok(records),
            _ => {}
        }
        let records = Self::pass(source, Some(count(source)?))?;
        if records.is_whole() { Ok(records) } else { Err(Error::Internal("OBJ records miscounted".into())) }
    }

    fn pass(source: &'a Source<'a>, total: Option<Counts>) -> Result<Self> {
        let mut records = Self {
            source,
            positions: Vec::new(),
            colors: Vec::new(),
            texture_coordinates: 0,
            normals: Vec::new(),
            triangles: Vec::new(),
            corner_normals: CornerNormals::default(),
            lines: Vec::new(),
            indices: Indices::new(total),
        };
        for_each_record(source, |offset, line| records.record(offset, line))?;
        Ok(records)
    }

    fn is_whole(&self) -> bool {
        self.indices.within(self.counts())
    }

    fn counts(&self) -> Counts {
        [self.positions.len() as u64, self.texture_coordinates, self.normals.len() as u64]
    }

    fn record(&mut self, offset: usize, line: &[u8]) -> Result<()> {
        let mut words = text::tokens(line);
        match words.next() {
            Some(b"v") => self.position(offset, words),
            Some(b"vn") => self.normal(offset, words),
            Some(b"vt") => {
                self.texture_coordinates += 1;
                Ok(())
            }
            Some(b"f") => self.face(offset, words),
            Some(b"l") => self.line(offset, words),
            // Names, groups, materials, free-form curves: nothing that is read.
            _ => Ok(()),
        }
    }

    /// `v x y z`, `v x y z w`, `v x y z r g b` or `v x y z r g b a`.
    fn position<'w>(&mut self, offset: usize, words: impl Iterator<Item = &'w [u8]>) -> Result<()> {
        let (values, count) = self.numbers(offset, words)?;
        if !matches!(count, 3 | 4 | 6 | 7) {
            let what = format!("a vertex has {count} numbers, not 3, 4 (with weight) or 6, 7 (with colour)");
            return Err(self.fault(offset, &what));
        }
        self.source.check_points(self.positions.len() as u64 + 1)?;
        if count >= 6 {
            self.colors.resize(self.positions.len(), color::WHITE);
            self.colors.push([values[3], values[4], values[5]].map(|channel| color::level(255.0 * channel)));
        } else if !self.colors.is_empty() {
            self.colors.push(color::WHITE);
        }
        self.positions.push(DVec3::from_slice(&values));
        Ok(())
    }

    fn normal<'w>(&mut self, offset: usize, words: impl Iterator<Item = &'w [u8]>) -> Result<()> {
        let (values, count) = self.numbers(offset, words)?;
        if count != 3 {
            return Err(self.fault(offset, &format!("a normal has {count} numbers, not 3")));
        }
        self.normals.push(DVec3::from_slice(&values).as_vec3());
        Ok(())
    }

    /// The numbers of a record and how many there are.
    fn numbers<'w>(
        &self,
        offset: usize,
        words: impl Iterator<Item = &'w [u8]>,
    ) -> Result<([f64; NUMBERS], usize)> {
        let (mut values, mut count) = ([0.0; NUMBERS], 0);
        for word in words.take_while(|word| word[0] != b'#') {
            let Some(value) = text::number(word) else {
                return Err(self.fault(offset, &format!("{} is no number", text::quote(word))));
            };
            let Some(slot) = values.get_mut(count) else {
                return Err(self.fault(offset, &format!("more than {NUMBERS} numbers")));
            };
            *slot = value;
            count += 1;
        }
        Ok((values, count))
    }

    fn face<'w>(&mut self, offset: usize, words: impl Iterator<Item = &'w [u8]>) -> Result<()> {
        let (mut first, mut last, mut count) = (0, 0, 0);
        for word in words.take_while(|word| word[0] != b'#') {
            let Corner { vertex, normal } = self.corner(offset, word)?;
            if let Some(normal) = normal {
                self.corner_normals.note(vertex, normal, &self.normals, self.positions.len());
            }
            match count {
                0 => first = vertex,
                1 => {}
                _ => self.triangles.push([first, last, vertex]),
            }
            last = vertex;
            count += 1;
        }
        if count < 3 {
            return Err(self.source.at_line(offset, faces::too_few(count)));
        }
        self.source.check_triangles(self.triangles.len() as u64)
    }

    fn line<'w>(&mut self, offset: usize, words: impl Iterator<Item = &'w [u8]>) -> Result<()> {
        let mut line = Vec::new();
        for word in words.take_while(|word| word[0] != b'#') {
            line.push(self.corner(offset, word)?.vertex);
        }
        if line.len() < 2 {
            let what = format!("a polyline has {} points, at least 2 are needed", line.len());
            return Err(self.fault(offset, &what));
        }
        self.lines.push((offset, line));
        Ok(())
    }

    fn corner(&mut self, offset: usize, word: &[u8]) -> Result<Corner> {
        let so_far = self.counts();
        self.indices.corner(word, so_far).map_err(|what| self.fault(offset, &what))
    }

    fn fault(&self, offset: usize, what: &str) -> Error {
        self.source.at_line(offset, format!("{what}; correct the line or export the file again"))
    }
}

/// Counts what can be indexed in the whole file.
fn count(source: &Source) -> Result<Counts> {
    let mut counts = [0; 3];
    for_each_record(source, |_, line| {
        match text::tokens(line).next() {
            Some(b"v") => counts[0] += 1,
            Some(b"vt") => counts[1] += 1,
            Some(b"vn") => counts[2] += 1,
            _ => {}
        }
        Ok(())
    })?;
    Ok(counts)
}

/// Hands over each record with its offset; a backslash at the end joins a line to the next.
fn for_each_record(source: &Source, mut take: impl FnMut(usize, &[u8]) -> Result<()>) -> Result<()> {
    let mut joined: Vec<u8> = Vec::new();
    let mut start = None;
    for line in text::lines(&source.bytes, 0) {
        let offset = *start.get_or_insert(line.offset);
        let is_comment = line.bytes.trim_ascii_start().starts_with(b"#");
        if !is_comment && let Some(part) = line.bytes.trim_ascii_end().strip_suffix(b"\\") {
            joined.extend_from_slice(part);
            joined.push(b' ');
            continue;
        }
        start = None;
        if joined.is_empty() {
            take(offset, line.bytes)?;
        } else {
            joined.extend_from_slice(line.bytes);
            take(offset, &joined)?;
            joined.clear();
        }
    }
    take(start.unwrap_or(source.bytes.len()), &joined)
}
