//! The surface as the stages below see it: points with neighbours, pieces to cover, borders.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::model::triangle::to_triangle;

/// Marks the absence of a point.
pub const NONE: u32 = u32::MAX;

/// Rows that one thread builds at a time.
const BLOCK: u32 = 1 << 12;

/// Lists of indices, one a row, stored end to end.
#[derive(Clone, Debug, Default)]
pub struct Rows {
    starts: Vec<u32>,
    items: Vec<u32>,
}

impl Rows {
    /// Rows from `(row, item)` pairs, which are sorted and freed of repeats first.
    #[must_use]
    pub fn from_pairs(rows: usize, mut pairs: Vec<(u32, u32)>) -> Self {
        pairs.sort_unstable();
        pairs.dedup();
        let starts = starts(rows, pairs.iter().map(|&(row, _)| row));
        Self { starts, items: pairs.into_iter().map(|(_, item)| item).collect() }
    }

    /// Rows in which whatever row lists another, that other lists it too.
    ///
    /// `listed` gives what a row lists at least; nothing twice, and not the row itself.
    #[must_use]
    pub fn symmetric<I: Iterator<Item = u32>>(rows: u32, listed: impl Fn(u32) -> I) -> Self {
        // Pairs would take several times the memory of the rows they become.
        let missing = |row: u32, other: u32| !listed(other).any(|back| back == row);
        let one_way = || (0..rows).flat_map(|row| listed(row).map(move |other| (row, other)));
        let pairs = || {
            one_way().flat_map(|(row, other)| {
                let back = missing(row, other).then_some((other, row));
                [(row, other)].into_iter().chain(back)
            })
        };
        let mut sorted = Self::placed(rows as usize, pairs);
        for row in 0..rows as usize {
            sorted.items[sorted.starts[row] as usize..sorted.starts[row + 1] as usize].sort_unstable();
        }
        sorted
    }

    /// Rows of the indices of `owner`, each in the row that it names, if it names one.
    #[must_use]
    pub fn grouped(rows: usize, owner: &[u32]) -> Self {
        Self::placed(rows, || owner.iter().copied().zip(0_u32..).filter(|&(row, _)| row != NONE))
    }

    /// Rows of `(row, item)` pairs, each row in their order; `pairs` is gone through twice.
    pub fn placed<I: Iterator<Item = (u32, u32)>>(rows: usize, pairs: impl Fn() -> I) -> Self {
        let starts = starts(rows, pairs().map(|(row, _)| row));
        let (mut items, mut ends) = (vec![0_u32; starts[rows] as usize], starts.clone());
        for (row, item) in pairs() {
            items[ends[row as usize] as usize] = item;
            ends[row as usize] += 1;
        }
        Self { starts, items }
    }

    /// `rows` rows of what `fill` adds to a list for each, ascending and freed of repeats.
    #[must_use]
    pub fn built(rows: u32, fill: impl Fn(u32, &mut Vec<u32>) + Sync) -> Self {
        let block = |block: u32| {
            let (mut lengths, mut items, mut row) = (Vec::new(), Vec::new(), Vec::new());
            for index in block * BLOCK..rows.min((block + 1) * BLOCK) {
                fill(index, &mut row);
                row.sort_unstable();
                row.dedup();
                lengths.push(row.len() as u32);
                items.append(&mut row);
            }
            (lengths, items)
        };
        let (lengths, items): (Vec<_>, Vec<_>) = (0..rows.div_ceil(BLOCK)).into_par_iter().map(block).unzip();
        Self { starts: ends(&lengths.concat()), items: items.concat() }
    }

    /// Rows of given lengths that hold `0, 1, 2` and so on.
    #[must_use]
    pub fn consecutive(lengths: &[u32]) -> Self {
        let starts = ends(lengths);
        Self { items: (0..starts[lengths.len()]).collect(), starts }
    }

    /// How many rows there are.
    #[must_use]
    pub fn count(&self) -> u32 {
        self.starts.len().saturating_sub(1) as u32
    }

    /// The items of a row.
    #[must_use]
    pub fn row(&self, row: u32) -> &[u32] {
        let row = row as usize;
        &self.items[self.starts[row] as usize..self.starts[row + 1] as usize]
    }
}

/// Where rows of these lengths start, and the last ends.
fn ends(lengths: &[u32]) -> Vec<u32> {
    let mut starts = vec![0_u32; lengths.len() + 1];
    for (row, length) in lengths.iter().enumerate() {
        starts[row + 1] = starts[row] + length;
    }
    starts
}

/// Where each row starts, and the last ends, if they hold one item each time they are named.
fn starts(rows: usize, named: impl Iterator<Item = u32>) -> Vec<u32> {
    let mut starts = vec![0_u32; rows + 1];
    for row in named {
        starts[row as usize + 1] += 1;
    }
    for row in 0..rows {
        starts[row + 1] += starts[row];
    }
    starts
}

/// A point of a cloud that a splat has to cover.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spot {
    /// Where it is, model units.
    pub position: Vec3,
    /// How far inside a splat it must lie to count as covered, model units: as far as it
    /// stands for the surface around it. Beside a feature line its cell tells more: [`Cells`].
    pub margin: f32,
}

/// Corners of what spots of a cloud stand for, where feature lines bound it; none of other spots, which stand for the
/// disc of their margin.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cells {
    /// Where those of each spot begin among all, and the last's end; empty where no spot has any.
    starts: Vec<u32>,
    corners: Vec<Vec3>,
}

impl Cells {
    /// The cells of all spots, in their order.
    #[must_use]
    pub fn new<'a>(cells: impl Iterator<Item = &'a [Vec3]>) -> Self {
        let (mut starts, mut corners) = (vec![0], Vec::new());
        for cell in cells {
            corners.extend_from_slice(cell);
            starts.push(corners.len() as u32);
        }
        if corners.is_empty() { Self::default() } else { Self { starts, corners } }
    }

    /// The corners of what a spot stands for, model units.
    #[must_use]
    pub fn of(&self, spot: u32) -> &[Vec3] {
        let spot = spot as usize;
        match self.starts.get(spot..spot + 2) {
            Some(&[from, to]) => &self.corners[from as usize..to as usize],
            _ => &[],
        }
    }
}

/// A sampled surface, cut along its feature lines.
///
/// A point on a feature line is there once for each side, so that whatever walks along
/// `neighbours` stays on its own side, and each side's samples reach the line itself.
#[derive(Clone, Debug, Default)]
pub struct Surface {
    /// Positions, model units.
    pub points: Vec<Vec3>,
    /// For each point the place it lies at: points of one place are the sides of a line there.
    pub places: Vec<u32>,
    /// Unit normals, outward.
    pub normals: Vec<Vec3>,
    /// Colours, or empty.
    pub colors: Vec<[u8; 3]>,
    /// For each point, those joined to it by the surface.
    pub neighbours: Rows,
    /// What must be covered: triangles of points; for a cloud the point that stands for a
    /// spot, three times.
    pub pieces: Vec<[u32; 3]>,
    /// For each piece of a cloud what it is; empty for a mesh.
    pub spots: Vec<Spot>,
    /// For each spot beside a feature line, what it stands for.
    pub cells: Cells,
    /// For each point, the pieces it is a corner of.
    pub pieces_of: Rows,
    /// For each point of a cloud, how far it stands for the surface around it. Zero for a mesh.
    pub margin: Vec<f32>,
    /// For each point the next one along the border, with the surface on the left; or [`NONE`].
    pub border_next: Vec<u32>,
    /// For each point, whether the side that starts there only carries a feature line on beyond its
    /// end. Empty where none is.
    pub carried: Vec<bool>,
    /// The inverse of `border_next`.
    pub border_prev: Vec<u32>,
}

impl Surface {
    /// A position in 64 bits.
    #[must_use]
    pub fn point(&self, index: u32) -> DVec3 {
        self.points[index as usize].as_dvec3()
    }

    /// A normal in 64 bits.
    #[must_use]
    pub fn normal(&self, index: u32) -> DVec3 {
        self.normals[index as usize].as_dvec3()
    }

    /// The pieces at some points, ascending.
    #[must_use]
    pub fn pieces_at(&self, points: impl Iterator<Item = u32>) -> Vec<u32> {
        let mut pieces: Vec<u32> = points.flat_map(|point| self.pieces_of.row(point)).copied().collect();
        pieces.sort_unstable();
        pieces.dedup();
        pieces
    }

    /// Whether a point lies on a feature line or border.
    #[must_use]
    pub fn on_border(&self, index: u32) -> bool {
        self.border_next[index as usize] != NONE || self.border_prev[index as usize] != NONE
    }

    /// The area a piece stands for, in squared model units.
    #[must_use]
    pub fn area(&self, piece: u32) -> f64 {
        if let Some(spot) = self.spots.get(piece as usize) {
            return f64::from(spot.margin) * f64::from(spot.margin);
        }
        let [a, b, c] = self.pieces[piece as usize].map(|corner| self.point(corner));
        0.5 * (b - a).cross(c - a).length()
    }

    /// Whether the border's side that starts at a point only carries a feature line on.
    #[must_use]
    pub fn is_carried(&self, point: u32) -> bool {
        self.carried.get(point as usize).copied().unwrap_or_default()
    }

    /// Notes along which edges, each given by its places, lines are only carried on.
    pub fn carried_on(&mut self, edges: impl Iterator<Item = [u32; 2]>) {
        let mut edges: Vec<[u32; 2]> = edges.map(|[a, b]| [a.min(b), a.max(b)]).collect();
        edges.sort_unstable();
        let place = |point: u32| self.places[point as usize];
        let side = |(from, &to): (u32, &u32)| {
            to != NONE
                && edges.binary_search(&[place(from).min(place(to)), place(from).max(place(to))]).is_ok()
        };
        self.carried = (0..).zip(&self.border_next).map(side).collect();
    }

    /// The middle of a piece.
    #[must_use]
    pub fn middle(&self, piece: u32) -> DVec3 {
        if let Some(spot) = self.spots.get(piece as usize) {
            return spot.position.as_dvec3();
        }
        let [a, b, c] = self.pieces[piece as usize].map(|corner| self.point(corner));
        (a + b + c) / 3.0
    }

    /// The squared distance of a place from a piece, in squared model units.
    #[must_use]
    pub fn distance_squared(&self, piece: u32, place: DVec3) -> f64 {
        if let Some(spot) = self.spots.get(piece as usize) {
            return spot.position.as_dvec3().distance_squared(place);
        }
        let corners = self.pieces[piece as usize].map(|corner| self.point(corner));
        to_triangle(corners, place).length_squared()
    }

    /// How far a piece stands for the surface around it, model units; 0 for a triangle.
    #[must_use]
    pub fn piece_margin(&self, piece: u32) -> f64 {
        self.spots.get(piece as usize).map_or(0.0, |spot| f64::from(spot.margin))
    }
}

/// Fills `border_prev` from `border_next`.
#[must_use]
pub fn inverse(next: &[u32]) -> Vec<u32> {
    let mut prev = vec![NONE; next.len()];
    for (from, &to) in next.iter().enumerate() {
        if to != NONE {
            prev[to as usize] = from as u32;
        }
    }
    prev
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_one_row_lists_the_other_lists_too() {
        let lists: [&[u32]; 4] = [&[1, 2], &[2], &[0], &[]];
        let rows = Rows::symmetric(4, |row| lists[row as usize].iter().copied());
        assert_eq!(
            (0..4).map(|row| rows.row(row).to_vec()).collect::<Vec<_>>(),
            [vec![1, 2], vec![0, 2], vec![0, 1], vec![]]
        );
    }

    #[test]
    fn built_rows_are_sorted_whatever_the_block() {
        let rows = Rows::built(3 * BLOCK + 7, |row, list| list.extend([row % 5, 9, row % 3, 9]));
        for row in 0..3 * BLOCK + 7 {
            let mut expected = vec![row % 5, row % 3, 9];
            expected.sort_unstable();
            expected.dedup();
            assert_eq!(rows.row(row), expected);
        }
    }
}
