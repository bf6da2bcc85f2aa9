//! Binary PLY bodies.

use rayon::prelude::*;

use super::super::faces::{NO_VERTEX, Shape, vertex};
use super::super::scalar::{Column, Endian, Rows, Scalar};
use super::super::source::Source;
use super::header::{Element, Encoding, Kind};
use super::table::{Table, Target};
use crate::error::{Error, Result};

/// Rows a task compares at a time.
const BLOCK: usize = 1 << 12;

/// Reads elements one after the other.
pub(super) struct Binary<'a> {
    pub source: &'a Source<'a>,
    pub endian: Endian,
    /// Offset of the next element.
    pub at: usize,
}

/// Where the properties lie when all rows are equally long.
struct Layout {
    stride: usize,
    /// For each property: where its number, or its list's first item, lies.
    offsets: Vec<usize>,
    /// For each property: the items of its list, 0 for a scalar.
    items: Vec<usize>,
}

/// A list's count that does not fit.
enum Fault {
    /// The body ends first; so many bytes are needed.
    End(u64),
    Negative(f64),
}

impl<'a> Binary<'a> {
    /// The wanted scalar columns.
    pub fn scalars(&mut self, element: &Element, wanted: &[usize]) -> Result<Table<'a>> {
        let count = element.check_room(self.source, self.at, Encoding::Binary(self.endian))?;
        if let Some((layout, rows)) = self.uniform(element, count) {
            self.at += layout.stride * count;
            let column = |&place: &usize| match element.properties[place].kind {
                Kind::Scalar(scalar) | Kind::List { count: scalar, .. } => {
                    Column { scalar, offset: layout.offsets[place] }
                }
            };
            return Ok(Table::Packed { rows, columns: wanted.iter().map(column).collect() });
        }
        let mut values = vec![0.0; count * wanted.len()];
        for (row, out) in values.chunks_exact_mut(wanted.len()).enumerate() {
            self.row(element, row, |place, numbers| {
                for slot in (0..wanted.len()).filter(|&slot| wanted[slot] == place) {
                    out[slot] = numbers[0];
                }
            })?;
        }
        Ok(Table::Values { values, width: wanted.len() })
    }

    /// The triangles of the lists of the property `corners`.
    pub fn triangles(&mut self, element: &Element, corners: usize, mut target: Target) -> Result<()> {
        let count = element.check_room(self.source, self.at, Encoding::Binary(self.endian))?;
        if let Some((layout, rows)) = self.uniform(element, count)
            && layout.items[corners] == 3
            && target.shape == Shape::Fan
            && self.bulk(element, corners, (&layout, rows), &mut target)?
        {
            self.at += layout.stride * count;
            return Ok(());
        }
        let mut list = Vec::new();
        for row in 0..count {
            let start = self.at;
            self.row(element, row, |place, numbers| {
                if place == corners {
                    list.clear();
                    list.extend_from_slice(numbers);
                }
            })?;
            let source = self.source;
            target.add(source, &list, |what| source.at(row_place(element, row, start), what))?;
        }
        Ok(())
    }

    /// Passes over an element.
    pub fn skip(&mut self, element: &Element) -> Result<()> {
        let count = element.check_room(self.source, self.at, Encoding::Binary(self.endian))?;
        match self.uniform(element, count) {
            Some((layout, _)) => self.at += layout.stride * count,
            None => {
                for row in 0..count {
                    self.row(element, row, |_, _| {})?;
                }
            }
        }
        Ok(())
    }

    /// All triangles at once; `false`, and nothing done, where an index is out of range.
    fn bulk(
        &self,
        element: &Element,
        corners: usize,
        (layout, rows): (&Layout, Rows),
        target: &mut Target,
    ) -> Result<bool> {
        let Kind::List { item, .. } = element.properties[corners].kind else { return Ok(false) };
        self.source.check_triangles((target.out.len() + rows.count) as u64)?;
        let first = layout.offsets[corners];
        let columns = [0, 1, 2].map(|n| Column { scalar: item, offset: first + n * item.size() });
        let vertices = target.vertices;
        let triangles = rows.gather(&columns, |values| values.map(|value| vertex(value, vertices)));
        if triangles.par_iter().any(|triangle| triangle.contains(&NO_VERTEX)) {
            return Ok(false);
        }
        if target.out.is_empty() {
            *target.out = triangles;
        } else {
            target.out.extend(triangles);
        }
        Ok(true)
    }

    /// The layout of an element whose rows are all as long as the first, and its rows.
    fn uniform(&self, element: &Element, count: usize) -> Option<(Layout, Rows<'a>)> {
        let source = self.source;
        let bytes = &source.bytes[self.at..];
        let mut layout = Layout { stride: 0, offsets: Vec::new(), items: Vec::new() };
        let mut counts = Vec::new();
        for property in &element.properties {
            let (start, items, size) = match property.kind {
                Kind::Scalar(scalar) => (layout.stride, 0, scalar.size()),
                Kind::List { count, item } => {
                    let field = layout.stride..layout.stride + count.size();
                    let items = self.items(bytes.get(layout.stride..)?, count, item).ok()?;
                    counts.push(field.clone());
                    (field.end, items, items * item.size())
                }
            };
            layout.offsets.push(start);
            layout.items.push(items);
            layout.stride = start + size;
        }
        let bytes = bytes.get(..layout.stride.checked_mul(count)?)?;
        let first = bytes.get(..layout.stride)?;
        let alike = |row: &[u8]| counts.iter().all(|field| row[field.clone()] == first[field.clone()]);
        let uniform = counts.is_empty()
            || bytes
                .par_chunks(layout.stride * BLOCK)
                .all(|block| block.chunks_exact(layout.stride).all(alike));
        let rows = Rows { bytes, stride: layout.stride, count, endian: self.endian };
        uniform.then_some((layout, rows))
    }

    /// The number of items of the list at the front of `bytes`, all of which are there.
    fn items(&self, bytes: &[u8], count: Scalar, item: Scalar) -> std::result::Result<usize, Fault> {
        let stored = count.read(self.endian, bytes).ok_or(Fault::End(count.size() as u64))?;
        if stored < 0.0 {
            return Err(Fault::Negative(stored));
        }
        let need = count.size() as u64 + stored as u64 * item.size() as u64;
        if need > bytes.len() as u64 { Err(Fault::End(need)) } else { Ok(stored as usize) }
    }

    /// Reads one row whose lists may have any length; `take` gets each property's numbers.
    fn row(&mut self, element: &Element, row: usize, mut take: impl FnMut(usize, &[f64])) -> Result<()> {
        let mut list = Vec::new();
        for (place, property) in element.properties.iter().enumerate() {
            let rest = &self.source.bytes[self.at..];
            let fault = |fault| self.fault(element, row, &property.name, fault);
            match property.kind {
                Kind::Scalar(scalar) => {
                    let end = || fault(Fault::End(scalar.size() as u64));
                    take(place, &[scalar.read(self.endian, rest).ok_or_else(end)?]);
                    self.at += scalar.size();
                }
                Kind::List { count, item } => {
                    let items = self.items(rest, count, item).map_err(fault)?;
                    let size = items * item.size();
                    let column = [Column { scalar: item, offset: 0 }];
                    let bytes = &rest[count.size()..count.size() + size];
                    let rows = Rows { bytes, stride: item.size(), count: items, endian: self.endian };
                    list.clear();
                    rows.each(&column, |[value]| list.push(value));
                    take(place, &list);
                    self.at += count.size() + size;
                }
            }
        }
        Ok(())
    }

    fn fault(&self, element: &Element, row: usize, property: &str, fault: Fault) -> Error {
        let left = self.source.bytes.len() - self.at;
        let what = match fault {
            Fault::End(need) => format!(
                "property `{property}` needs {need} bytes, and {left} follow; the file is cut short, \
                 export or copy it again"
            ),
            Fault::Negative(count) => {
                format!("list `{property}` has the count {count}; the file is damaged, export it again")
            }
        };
        self.source.at(row_place(element, row, self.at), what)
    }
}

fn row_place(element: &Element, row: usize, at: usize) -> String {
    format!("element `{}`, row {row} of {}, byte {at}", element.name, element.count)
}
