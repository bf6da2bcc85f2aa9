//! The `edge` element: feature lines.

use glam::DVec3;

use super::super::assemble::Geometry;
use super::super::chain;
use super::super::faces::{self, NO_VERTEX};
use super::super::source::Source;
use super::header::{self, Element};
use super::{Body, count_vertices, read_vertices};
use crate::error::Result;
use crate::model::polyline::Polylines;

/// Reads the `edge` element.
pub(in super::super) fn read_edges(source: &Source) -> Result<Polylines> {
    let header = header::parse(source)?;
    let vertices = count_vertices(source, &header)?;
    if header.elements.iter().all(|element| element.name != "edge" || element.count == 0) {
        return Err(source.at(
            "header",
            "no `edge` element with vertex1 and vertex2; export the feature lines as PLY edges or as \
             OBJ `l` records",
        ));
    }
    let needed = |element: &Element| element.name == "vertex" || element.name == "edge";
    let mut body = Body::of(source, &header);
    let mut geometry = Geometry::default();
    let mut edges = Vec::new();
    for element in header.up_to_last(needed) {
        match element.name.as_str() {
            "vertex" => read_vertices(source, &mut body, element, &mut geometry)?,
            "edge" => edges = read_pairs(source, &mut body, element, vertices)?,
            _ => body.skip(element)?,
        }
    }
    polylines(source, &geometry.positions.into_stored(), &edges)
}

fn polylines(source: &Source, positions: &[DVec3], edges: &[[u32; 2]]) -> Result<Polylines> {
    let used = edges.iter().enumerate().flat_map(|(n, pair)| pair.map(|v| (n, v)));
    for (n, v) in used {
        let point = positions[v as usize];
        if !point.is_finite() {
            return Err(source.at(
                format!("element `edge`, row {n}"),
                format!("uses vertex {v} at {point}, which is not finite; remove the edge"),
            ));
        }
    }
    let place = |line: Vec<u32>| line.into_iter().map(|v| positions[v as usize]).collect();
    let lines: Vec<_> = chain::chain(edges).into_iter().map(place).collect();
    if lines.is_empty() {
        return Err(source.at("element `edge`", "no edge joins two different vertices; export again"));
    }
    Ok(Polylines { lines })
}

fn read_pairs(source: &Source, body: &mut Body, element: &Element, vertices: u32) -> Result<Vec<[u32; 2]>> {
    let ends = ["vertex1", "vertex2"].map(|name| element.scalar(name).map(|(place, _)| place));
    let [Some(one), Some(two)] = ends else {
        return Err(source.at_line(
            element.offset,
            "element `edge` needs the scalar properties vertex1 and vertex2; export again",
        ));
    };
    let table = body.scalars(element, &[one, two])?;
    let stored = table.triples([0, 1, 1], |values| values);
    let mut pairs = Vec::with_capacity(stored.len());
    for (row, &[a, b, _]) in stored.iter().enumerate() {
        let pair = [faces::vertex(a, vertices), faces::vertex(b, vertices)];
        if pair.contains(&NO_VERTEX) {
            let bad = if pair[0] == NO_VERTEX { a } else { b };
            return Err(source.at(format!("element `edge`, row {row}"), faces::out_of_range(bad, vertices)));
        }
        pairs.push(pair);
    }
    Ok(pairs)
}
