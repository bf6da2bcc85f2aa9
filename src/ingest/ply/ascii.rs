//! Text PLY bodies: a line for each row.

use rayon::prelude::*;

use super::super::source::Source;
use super::super::text::{self, Line};
use super::header::{Element, Encoding, Kind};
use super::table::Target;
use crate::error::{Error, Result};

/// Lines a task takes on at a time.
const BLOCK: usize = 1 << 12;

/// Reads elements one after the other.
pub(super) struct Ascii<'a> {
    pub source: &'a Source<'a>,
    /// Offset of the next line.
    pub at: usize,
}

impl<'a> Ascii<'a> {
    /// The wanted scalar properties, row after row.
    pub fn scalars(&mut self, element: &Element, wanted: &[usize]) -> Result<Vec<f64>> {
        let lines = self.lines(element)?;
        let parse = |lines: &[Line]| {
            let mut values = vec![0.0; lines.len() * wanted.len()];
            for (line, out) in lines.iter().zip(values.chunks_exact_mut(wanted.len())) {
                self.row(
                    element,
                    *line,
                    |place| wanted.contains(&place),
                    |place, numbers| {
                        for slot in (0..wanted.len()).filter(|&slot| wanted[slot] == place) {
                            out[slot] = numbers[0];
                        }
                    },
                )?;
            }
            Ok(values)
        };
        let blocks: Vec<Result<Vec<f64>>> = lines.par_chunks(BLOCK).map(parse).collect();
        // In order, so that the first fault of the file is the one reported.
        let blocks = blocks.into_iter().collect::<Result<Vec<_>>>()?;
        Ok(blocks.concat())
    }

    /// The triangles of the lists of the property `corners`.
    pub fn triangles(&mut self, element: &Element, corners: usize, mut target: Target) -> Result<()> {
        let lines = self.lines(element)?;
        let parse = |lines: &[Line]| {
            let (mut numbers, mut ends) = (Vec::new(), Vec::with_capacity(lines.len()));
            for line in lines {
                self.row(
                    element,
                    *line,
                    |place| place == corners,
                    |_, list| numbers.extend_from_slice(list),
                )?;
                ends.push(numbers.len());
            }
            Ok((numbers, ends))
        };
        let blocks: Vec<Result<(Vec<f64>, Vec<usize>)>> = lines.par_chunks(BLOCK).map(parse).collect();
        for (block, lines) in blocks.into_iter().zip(lines.chunks(BLOCK)) {
            let (numbers, ends) = block?;
            let mut start = 0;
            for (&end, line) in ends.iter().zip(lines) {
                target.add(self.source, &numbers[start..end], |what| {
                    self.source.at_line(line.offset, format!("element `{}`: {what}", element.name))
                })?;
                start = end;
            }
        }
        Ok(())
    }

    /// Passes over an element.
    pub fn skip(&mut self, element: &Element) -> Result<()> {
        self.lines(element).map(drop)
    }

    /// The next lines that are not blank, one for each row.
    fn lines(&mut self, element: &Element) -> Result<Vec<Line<'a>>> {
        let count = element.check_room(self.source, self.at, Encoding::Ascii)?;
        let source = self.source;
        let rows = text::lines(&source.bytes, self.at).filter(|line| !line.bytes.trim_ascii().is_empty());
        let lines: Vec<_> = rows.take(count).collect();
        if lines.len() < count {
            let what = format!(
                "element `{}` has {} of its {count} rows; the file is cut short, export or copy it again",
                element.name,
                lines.len()
            );
            return Err(source.at_line(source.bytes.len(), what));
        }
        self.at = lines.last().map_or(self.at, |line| line.offset + line.bytes.len() + 1);
        Ok(lines)
    }

    /// Reads one row; `take` gets the numbers of each property that is `wanted`.
    fn row(
        &self,
        element: &Element,
        line: Line,
        wanted: impl Fn(usize) -> bool,
        mut take: impl FnMut(usize, &[f64]),
    ) -> Result<()> {
        let mut words = text::tokens(line.bytes);
        let mut list = Vec::new();
        for (place, property) in element.properties.iter().enumerate() {
            let mut next = || {
                words.next().ok_or_else(|| {
                    self.fault(element, line, &format!("property `{}` is missing", property.name))
                })
            };
            let number = |word: &[u8]| {
                text::number(word).ok_or_else(|| {
                    let what = format!("property `{}`: {} is no number", property.name, text::quote(word));
                    self.fault(element, line, &what)
                })
            };
            match property.kind {
                Kind::Scalar(_) if wanted(place) => take(place, &[number(next()?)?]),
                Kind::Scalar(_) => {
                    next()?;
                }
                Kind::List { .. } => {
                    let word = next()?;
                    let count = text::integer(word).and_then(|count| usize::try_from(count).ok());
                    let Some(count) = count else {
                        let what = format!("list `{}`: {} is no count", property.name, text::quote(word));
                        return Err(self.fault(element, line, &what));
                    };
                    list.clear();
                    for _ in 0..count {
                        list.push(number(next()?)?);
                    }
                    if wanted(place) {
                        take(place, &list);
                    }
                }
            }
        }
        match words.next() {
            None => Ok(()),
            Some(word) => {
                let what = format!("{} follows the last property", text::quote(word));
                Err(self.fault(element, line, &what))
            }
        }
    }

    fn fault(&self, element: &Element, line: Line, what: &str) -> Error {
        let what = format!("element `{}`: {what}; correct the line or export the file again", element.name);
        self.source.at_line(line.offset, what)
    }
}
