//! Parts faces that lie back to back, as leaves and flags have them that are to be seen from both sides.
//!
//! Where every edge has four faces none joins its neighbour. Apart, each side is a surface.

use super::edges::{Edges, Half};
use super::sets::Sets;
use super::surface::NONE;
use super::weld::Welded;

/// Gives one of each two sheets of triangles that lie back to back, of the same corners in opposite
/// order, vertices of its own, behind all others. Sheets with one side, such as a Moebius strip's, stay
/// as they are.
pub(super) fn part(welded: &mut Welded) {
    let twins = twins(&welded.triangles);
    if twins.iter().all(|&twin| twin == NONE) {
        return;
    }
    let mut sheets = sheets(&welded.triangles, &twins);
    let is_behind =
        |(face, &twin): (usize, &u32)| twin != NONE && sheets.root(face as u32) > sheets.root(twin);
    let behind: Vec<bool> = twins.iter().enumerate().map(is_behind).collect();
    copy_vertices(welded, &behind);
}

/// For each triangle the one of the same corners in opposite order, or [`NONE`]. None is repeated.
fn twins(triangles: &[[u32; 3]]) -> Vec<u32> {
    let sorted = |&corners: &[u32; 3]| {
        let mut corners = corners;
        corners.sort_unstable();
        corners
    };
    let mut keys: Vec<([u32; 3], u32)> = triangles.iter().map(sorted).zip(0..).collect();
    keys.sort_unstable();
    let mut twins = vec![NONE; triangles.len()];
    for pair in keys.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
        let [a, b] = [pair[0].1, pair[1].1];
        twins[a as usize] = b;
        twins[b as usize] = a;
    }
    twins
}

/// The triangles that have twins, joined over edges where two such pairs meet and nothing else does.
fn sheets(triangles: &[[u32; 3]], twins: &[u32]) -> Sets {
    let edges = Edges::of(triangles);
    let mut sheets = Sets::new(triangles.len());
    for edge in &edges.edges {
        let halves = edges.halves(edge);
        let goes_on = |one: &&Half, other: &&Half| {
            one.forward != other.forward && other.face != twins[one.face as usize]
        };
        if let [first, rest @ ..] = halves
            && rest.len() == 3
            && halves.iter().all(|half| twins[half.face as usize] != NONE)
            && let Some(next) = rest.iter().find(|other| goes_on(&first, other))
        {
            sheets.merge(first.face, next.face);
            sheets.merge(twins[first.face as usize], twins[next.face as usize]);
        }
    }
    sheets
}

/// Appends copies of the vertices of some triangles, which take these instead.
fn copy_vertices(welded: &mut Welded, behind: &[bool]) {
    let mut copied = vec![false; welded.positions.len()];
    let of_behind = || behind.iter().enumerate().filter(|(_, behind)| **behind).map(|(face, _)| face);
    of_behind().flat_map(|face| welded.triangles[face]).for_each(|vertex| copied[vertex as usize] = true);
    let mut copies = vec![NONE; copied.len()];
    for vertex in (0..copied.len()).filter(|&vertex| copied[vertex]) {
        copies[vertex] = welded.positions.len() as u32;
        welded.positions.push(welded.positions[vertex]);
        if !welded.colors.is_empty() {
            welded.colors.push(welded.colors[vertex]);
        }
    }
    for face in of_behind() {
        welded.triangles[face] = welded.triangles[face].map(|vertex| copies[vertex as usize]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// Triangles over so many vertices, each and its back.
    fn both_sides(vertices: u32, triangles: &[[u32; 3]]) -> Welded {
        let backs = triangles.iter().map(|&[a, b, c]| [a, c, b]);
        let mut triangles: Vec<[u32; 3]> = triangles.iter().copied().chain(backs).collect();
        triangles.sort_unstable();
        let positions = (0..vertices).map(|n| Vec3::new(n as f32, (n * n) as f32, 0.0)).collect();
        Welded { positions, triangles, ..Welded::default() }
    }

    /// Edges at which two triangles join, of all.
    fn joined(welded: &Welded) -> (usize, usize) {
        let edges = Edges::of(&welded.triangles);
        (edges.edges.iter().filter(|edge| edges.pair(edge).is_some()).count(), edges.edges.len())
    }

    #[test]
    fn a_sheet_seen_from_both_sides_becomes_two() {
        let mut strip = both_sides(4, &[[0, 1, 2], [1, 3, 2]]);
        assert_eq!(joined(&strip), (4, 5), "as one: its rim alone");
        part(&mut strip);
        assert_eq!(joined(&strip), (2, 10));
        assert_eq!(strip.positions.len(), 8);
        assert_eq!(strip.positions[..4], strip.positions[4..]);
    }

    #[test]
    fn what_has_no_back_stays() {
        let mut strip = both_sides(4, &[[0, 1, 2]]);
        strip.triangles.push([1, 3, 2]);
        let alone = *strip.triangles.last().expect("the one just added");
        part(&mut strip);
        assert_eq!((strip.triangles[2], strip.positions.len()), (alone, 7));
        let plain = Welded { triangles: vec![[0, 1, 2], [1, 3, 2]], ..both_sides(4, &[]) };
        let mut same = plain.clone();
        part(&mut same);
        assert_eq!(same.triangles, plain.triangles);
    }

    #[test]
    fn a_sheet_with_one_side_stays_as_it_is() {
        let strip = [[0, 1, 2], [1, 3, 2], [2, 3, 4], [3, 5, 4], [4, 5, 1], [5, 0, 1]];
        let mut strip = both_sides(6, &strip);
        let before = strip.triangles.clone();
        part(&mut strip);
        assert_eq!(strip.triangles, before);
    }
}
