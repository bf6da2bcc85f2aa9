//! The text header of a PLY file.

use std::collections::BTreeSet;

use super::super::scalar::{Endian, Scalar};
use super::super::source::Source;
use super::super::text::{self, Line};
use crate::error::{Error, Result};

/// Longest header, in bytes: comments may be long, but a header that never ends must not be
/// sought through gigabytes of body.
const HEADER_BYTES: usize = 1 << 20;

/// Fewest bytes of a value in a text: a digit and what separates it from the next.
const LEAST_VALUE: usize = 2;

/// How the body is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    Binary(Endian),
}

/// Type of a property.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Scalar(Scalar),
    List { count: Scalar, item: Scalar },
}

#[derive(Debug)]
pub(super) struct Property {
    pub name: String,
    pub kind: Kind,
}

/// A table of the body.
#[derive(Debug)]
pub(super) struct Element {
    pub name: String,
    /// Rows that the header claims.
    pub count: u64,
    pub properties: Vec<Property>,
    /// Where the header declares it.
    pub offset: usize,
}

#[derive(Debug)]
pub(super) struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
    /// Offset of the first byte of the body.
    pub body: usize,
}

impl Element {
    /// Place and type of a scalar property.
    pub fn scalar(&self, name: &str) -> Option<(usize, Scalar)> {
        self.properties.iter().enumerate().find_map(|(place, property)| match property.kind {
            Kind::Scalar(scalar) if property.name == name => Some((place, scalar)),
            _ => None,
        })
    }

    /// Fewest bytes of a row: every list empty.
    pub fn least_row(&self, encoding: Encoding) -> usize {
        let size = |property: &Property| match (encoding, property.kind) {
            (Encoding::Ascii, _) => LEAST_VALUE,
            (_, Kind::Scalar(scalar) | Kind::List { count: scalar, .. }) => scalar.size(),
        };
        self.properties.iter().map(size).sum()
    }

    /// Refuses more rows than fit in what is left of the file; nothing is allocated before.
    pub fn check_room(&self, source: &Source, at: usize, encoding: Encoding) -> Result<usize> {
        let least_row = self.least_row(encoding);
        // The last value of a text needs no separator after it.
        let spare = u64::from(encoding == Encoding::Ascii);
        let left = source.bytes.len().saturating_sub(at) as u64 + spare;
        let need = self.count.saturating_mul(least_row as u64);
        if need > left {
            let what = format!(
                "{} rows of at least {least_row} bytes need {need} bytes, and {left} follow; the file is \
                 cut short or its header damaged, export or copy it again",
                self.count
            );
            return Err(source.at(format!("element `{}`, byte {at}", self.name), what));
        }
        usize::try_from(self.count).map_err(|_| Error::Internal("row count above the file's size".into()))
    }
}

impl Header {
    /// The elements up to the last one that is needed: what follows is not read.
    pub fn up_to_last(&self, needed: impl Fn(&Element) -> bool) -> &[Element] {
        let end = self.elements.iter().rposition(needed).map_or(0, |last| last + 1);
        &self.elements[..end]
    }
}

/// Parses the header.
pub(super) fn parse(source: &Source) -> Result<Header> {
    let front = &source.bytes[..source.bytes.len().min(HEADER_BYTES)];
    let mut lines = text::lines(front, 0);
    let first = lines.next().map_or(&[][..], |line| line.bytes);
    if first.trim_ascii() != b"ply" {
        return Err(
            source.at_line(0, format!("begins with {}, not with `ply`; is it a PLY?", text::quote(first)))
        );
    }
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    let mut names = BTreeSet::new();
    for line in lines {
        let words: Vec<&[u8]> = text::tokens(line.bytes).collect();
        match words.as_slice() {
            [] | [b"comment" | b"obj_info", ..] => {}
            [b"format", name, ..] => encoding = Some(parse_encoding(source, line, name)?),
            [b"element", name, count] => {
                let element = parse_element(source, line, name, count)?;
                unique(source, line, &mut names, (element.name.clone(), None))?;
                elements.push(element);
            }
            [b"property", rest @ ..] => {
                let Some(element) = elements.last_mut() else {
                    return Err(fault(source, line, "a property before the first element"));
                };
                let property = parse_property(source, line, rest)?;
                unique(source, line, &mut names, (element.name.clone(), Some(property.name.clone())))?;
                element.properties.push(property);
            }
            [b"end_header"] => {
                let body = (line.offset + line.bytes.len() + 1).min(source.bytes.len());
                return finish(source, encoding, elements, body);
            }
            _ => {
                let what = format!("{} is no header record", text::quote(line.bytes.trim_ascii()));
                return Err(fault(source, line, &what));
            }
        }
    }
    Err(source.at(
        format!("byte {}", front.len()),
        "the header has no `end_header` line; the file is cut short, export or copy it again",
    ))
}

fn finish(
    source: &Source,
    encoding: Option<Encoding>,
    elements: Vec<Element>,
    body: usize,
) -> Result<Header> {
    let Some(encoding) = encoding else {
        return Err(source.at("header", "no `format` line; export the file again"));
    };
    if let Some(bare) = elements.iter().find(|element| element.properties.is_empty() && element.count > 0) {
        let what = format!("element `{}` has rows but no property; export the file again", bare.name);
        return Err(source.at_line(bare.offset, what));
    }
    Ok(Header { encoding, elements, body })
}

fn parse_encoding(source: &Source, line: Line, name: &[u8]) -> Result<Encoding> {
    match name {
        b"ascii" => Ok(Encoding::Ascii),
        b"binary_little_endian" => Ok(Encoding::Binary(Endian::Little)),
        b"binary_big_endian" => Ok(Encoding::Binary(Endian::Big)),
        _ => Err(fault(source, line, &format!("{} is no PLY format", text::quote(name)))),
    }
}

fn parse_element(source: &Source, line: Line, name: &[u8], count: &[u8]) -> Result<Element> {
    let parsed = std::str::from_utf8(count).ok().and_then(|text| text.parse().ok());
    let Some(count) = parsed else {
        return Err(fault(source, line, &format!("{} is no row count", text::quote(count))));
    };
    let name = String::from_utf8_lossy(name).into_owned();
    Ok(Element { name, count, properties: Vec::new(), offset: line.offset })
}

fn parse_property(source: &Source, line: Line, words: &[&[u8]]) -> Result<Property> {
    let scalar = |word: &[u8]| {
        parse_scalar(word).ok_or_else(|| {
            let what = format!(
                "{} is no property type (char, uchar, short, ushort, int, uint, float, double)",
                text::quote(word)
            );
            fault(source, line, &what)
        })
    };
    let (kind, name) = match words {
        [b"list", count, item, name] => {
            let (count, item) = (scalar(count)?, scalar(item)?);
            if count.is_float() {
                return Err(fault(source, line, "the count of a list must be an integer type"));
            }
            (Kind::List { count, item }, name)
        }
        [kind, name] => (Kind::Scalar(scalar(kind)?), name),
        _ => return Err(fault(source, line, "a property needs a type and a name")),
    };
    Ok(Property { name: String::from_utf8_lossy(name).into_owned(), kind })
}

fn parse_scalar(word: &[u8]) -> Option<Scalar> {
    Some(match word {
        b"char" | b"int8" => Scalar::I8,
        b"uchar" | b"uint8" => Scalar::U8,
        b"short" | b"int16" => Scalar::I16,
        b"ushort" | b"uint16" => Scalar::U16,
        b"int" | b"int32" => Scalar::I32,
        b"uint" | b"uint32" => Scalar::U32,
        b"float" | b"float32" => Scalar::F32,
        b"double" | b"float64" => Scalar::F64,
        _ => return None,
    })
}

type Name = (String, Option<String>);

fn unique(source: &Source, line: Line, names: &mut BTreeSet<Name>, name: Name) -> Result<()> {
    if names.contains(&name) {
        let twice = name.1.as_ref().unwrap_or(&name.0);
        return Err(fault(source, line, &format!("`{twice}` is declared twice")));
    }
    names.insert(name);
    Ok(())
}

fn fault(source: &Source, line: Line, what: &str) -> Error {
    source.at_line(line.offset, format!("{what}; the PLY header is damaged, export the file again"))
}
