//! Closes cracks: borders of a mesh that run side by side much nearer than the bound.
//!
//! Patches whose common border was rounded twice, or that share only some of its vertices (T-junctions), do not join
//! in the file. Unsewn, a smooth surface would end at every crack.

use std::collections::BTreeMap;

use glam::DVec3;

use super::back_to_back;
use super::edges::Edges;
use super::segment_grid::SegmentGrid;
use super::sets::Sets;
use super::weld::Welded;

/// Cracks at most so wide, as a share of the bound, are closed: what closing them moves splats make up for by a fit
/// that is so much nearer.
pub const CRACK_SHARE: f64 = 1.0 / 16.0;

/// Sewn to at most this share of their length, borders are simpler even if they make more loops.
const SIMPLER: f64 = 0.5;

/// What was sewn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sewn {
    /// Vertices that became one with others, or corners of triangles whose sides passed them.
    pub vertices: usize,
    /// How far any place of the surface was moved for that at most, model units.
    pub moved: f64,
}

/// Joins vertices on borders that lie `within` a distance of each other, but for those of one triangle or at one place;
/// then splits triangles whose sides on borders pass other such vertices so near.
///
/// All stays as it was where that leaves many short borders of few long ones, as it does where cracks are about so
/// wide: each would have to be cut along by itself.
pub fn sew(welded: &mut Welded, within: f64) -> Sewn {
    let before = welded.clone();
    let (joined, split) = (join(welded, within), split_sides(welded, within));
    // A side may be moved with its ends, and bent between them.
    let sewn = Sewn { vertices: joined.vertices + split.vertices, moved: joined.moved + split.moved };
    if sewn.vertices > 0 && !Extent::of(welded).is_simpler(&Extent::of(&before)) {
        *welded = before;
        return Sewn::default();
    }
    sewn
}

/// How much there is of the borders of a mesh.
struct Extent {
    /// Model units.
    length: f64,
    /// How many loops they make; where some meet at a vertex, each counts.
    loops: usize,
}

impl Extent {
    fn of(welded: &Welded) -> Self {
        let borders = borders(&Edges::of(&welded.triangles));
        let mut met = Sets::new(welded.positions.len());
        borders.iter().for_each(|&([a, b], _)| met.merge(a, b));
        let distinct = |mut numbers: Vec<u32>| {
            numbers.sort_unstable();
            numbers.dedup();
            numbers.len()
        };
        let vertices = distinct(borders.iter().flat_map(|&(ends, _)| ends).collect());
        let parts = distinct(borders.iter().map(|&([a, _], _)| met.root(a)).collect());
        let length = |&(ends, _): &([u32; 2], u32)| {
            let [from, to] = welded.places(ends);
            from.distance(to)
        };
        // The independent cycles of a graph.
        Self { length: borders.iter().map(length).sum(), loops: borders.len() + parts - vertices }
    }

    fn is_simpler(&self, before: &Self) -> bool {
        self.loops <= before.loops || self.length <= SIMPLER * before.length
    }
}

/// The edges at which one face ends, each with the face's number.
fn borders(edges: &Edges) -> Vec<([u32; 2], u32)> {
    let alone = edges.edges.iter().filter(|edge| edge.faces == 1);
    alone.map(|edge| (edge.ends, edges.halves(edge)[0].face)).collect()
}

/// The vertices on borders, ascending, but for those of sheets that were parted as they lie back to back.
fn vertices(welded: &Welded, borders: &[([u32; 2], u32)]) -> Vec<u32> {
    let mut met: Vec<u32> = borders.iter().flat_map(|&(ends, _)| ends).collect();
    met.sort_unstable();
    met.dedup();
    let key = |vertex: u32| welded.positions[vertex as usize].to_array().map(f32::to_bits);
    let mut by_place = met.clone();
    by_place.sort_unstable_by_key(|&vertex| key(vertex));
    let twins = by_place.chunk_by(|&a, &b| key(a) == key(b)).filter(|same| same.len() > 1);
    let mut twins: Vec<u32> = twins.flatten().copied().collect();
    twins.sort_unstable();
    met.retain(|vertex| twins.binary_search(vertex).is_err());
    met
}

/// Joins each vertex onto the nearest that stays, so that none moves farther than that.
fn join(welded: &mut Welded, within: f64) -> Sewn {
    let vertices = vertices(welded, &borders(&Edges::of(&welded.triangles)));
    let triangles = Around::of(welded, &vertices);
    let mut staying = Staying::new(within);
    let mut to: Vec<u32> = (0..welded.positions.len() as u32).collect();
    let mut sewn = Sewn::default();
    for vertex in vertices {
        let [place] = welded.places([vertex]);
        // No triangle may lose a corner: a piece smaller than cracks are wide would be gone.
        let beside = triangles.corners(welded, vertex).map(|corner| to[corner as usize]);
        let beside: Vec<u32> = beside.collect();
        match staying.nearest(place, |other| !beside.contains(&other)) {
            Some((distance, near)) => {
                to[vertex as usize] = near;
                sewn = Sewn { vertices: sewn.vertices + 1, moved: sewn.moved.max(distance) };
            }
            None => staying.add(place, vertex),
        }
    }
    if sewn.vertices > 0 {
        let joined = welded.triangles.iter().map(|corners| corners.map(|vertex| to[vertex as usize]));
        welded.replace(joined.collect());
        // Two sides of a thin sheet may have become one.
        back_to_back::part(welded);
    }
    sewn
}

/// The triangles at some vertices.
struct Around {
    /// `(vertex, triangle)`, ascending.
    at: Vec<(u32, u32)>,
}

impl Around {
    /// `vertices` ascend.
    fn of(welded: &Welded, vertices: &[u32]) -> Self {
        let corners = (0..).zip(&welded.triangles).flat_map(|(face, corners)| corners.map(|v| (v, face)));
        let mut at: Vec<(u32, u32)> =
            corners.filter(|(vertex, _)| vertices.binary_search(vertex).is_ok()).collect();
        at.sort_unstable();
        Self { at }
    }

    /// The corners of the triangles at a vertex, perhaps repeatedly, but for itself.
    fn corners<'a>(&'a self, welded: &'a Welded, vertex: u32) -> impl Iterator<Item = u32> + 'a {
        let from = self.at.partition_point(|&(at, _)| at < vertex);
        let faces = self.at[from..].iter().take_while(move |&&(at, _)| at == vertex);
        let corners = faces.flat_map(|&(_, face)| welded.triangles[face as usize]);
        corners.filter(move |&corner| corner != vertex)
    }
}

/// Vertices that stay, in cells as wide as cracks: few lie in one, however many were joined there.
struct Staying {
    within: f64,
    cells: BTreeMap<[i64; 3], Vec<(DVec3, u32)>>,
}

impl Staying {
    fn new(within: f64) -> Self {
        Self { within, cells: BTreeMap::new() }
    }

    fn cell(&self, place: DVec3) -> [i64; 3] {
        (place / self.within).floor().as_i64vec3().to_array()
    }

    fn add(&mut self, place: DVec3, vertex: u32) {
        self.cells.entry(self.cell(place)).or_default().push((place, vertex));
    }

    /// The nearest of some within reach of a place, and how far it lies; of equally near ones the least.
    fn nearest(&self, place: DVec3, among: impl Fn(u32) -> bool) -> Option<(f64, u32)> {
        let [low, high] = [-self.within, self.within].map(|aside| self.cell(place + aside));
        let columns = (low[0]..=high[0]).flat_map(|x| (low[1]..=high[1]).map(move |y| (x, y)));
        let cells = columns.flat_map(|(x, y)| self.cells.range([x, y, low[2]]..=[x, y, high[2]]));
        let near = cells.flat_map(|(_, met)| met).map(|&(other, vertex)| (other.distance(place), vertex));
        let near = near.filter(|&(distance, vertex)| distance <= self.within && among(vertex));
        near.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))
    }
}

fn split_sides(welded: &mut Welded, within: f64) -> Sewn {
    let edges = Edges::of(&welded.triangles);
    let mut borders = borders(&edges);
    let vertices = vertices(welded, &borders);
    // Shorter ones have no place so far from both ends, and what passes one side of a narrow triangle passes others.
    let may_be_passed = |&(ends, face): &([u32; 2], u32)| {
        let [from, to] = welded.places(ends);
        from.distance(to) > 2.0 * within && welded.height(face, ends) > within
    };
    borders.retain(may_be_passed);
    let grid = SegmentGrid::new(borders.iter().map(|&(ends, _)| welded.places(ends)).collect());
    let mut sewn = Sewn::default();
    // For each side that is passed, how far along it its new corners lie.
    let mut passed: BTreeMap<usize, Vec<(f64, u32)>> = BTreeMap::new();
    for vertex in vertices {
        let [place] = welded.places([vertex]);
        for side in grid.within(place, within) {
            let (ends, face) = borders[side as usize];
            let [from, to] = welded.places(ends);
            let is_inside = place.distance(from).min(place.distance(to)) > within;
            if is_inside && !welded.triangles[face as usize].contains(&vertex) {
                let way = to - from;
                let along = (place - from).dot(way) / way.length_squared();
                passed.entry(side as usize).or_default().push((along, vertex));
                let off = place.distance(from + along * way);
                sewn = Sewn { vertices: sewn.vertices + 1, moved: sewn.moved.max(off) };
            }
        }
    }
    if sewn.vertices > 0 {
        let mut parts: BTreeMap<u32, Vec<[u32; 3]>> = BTreeMap::new();
        for (side, mut corners) in passed {
            let (ends, face) = borders[side];
            corners.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            let parts = parts.entry(face).or_insert_with(|| vec![welded.triangles[face as usize]]);
            split_side(parts, ends, &corners);
        }
        let whole = |face: &u32| !parts.contains_key(face);
        let rest =
            (0..welded.triangles.len() as u32).filter(whole).map(|face| welded.triangles[face as usize]);
        let all = rest.chain(parts.values().flatten().copied()).collect();
        welded.replace(all);
    }
    sewn
}

/// Splits the one of a triangle's parts that has a whole side from `from` to `to`, at corners in this order.
fn split_side(parts: &mut Vec<[u32; 3]>, [from, to]: [u32; 2], corners: &[(f64, u32)]) {
    let Some(part) = parts.iter().position(|part| part.contains(&from) && part.contains(&to)) else { return };
    let [a, b, c] = parts.swap_remove(part);
    let walk = [[a, b, c], [b, c, a], [c, a, b]];
    for [start, end, opposite] in walk {
        let is_forward = [start, end] == [from, to];
        if is_forward || [start, end] == [to, from] {
            let mut way: Vec<u32> = corners.iter().map(|&(_, corner)| corner).collect();
            if !is_forward {
                way.reverse();
            }
            way.insert(0, start);
            way.push(end);
            parts.extend(way.windows(2).map(|side| [side[0], side[1], opposite]));
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::super::weld::weld;
    use super::*;
    use crate::model::cloud::Cloud;
    use crate::model::mesh::Mesh;

    /// How near borders are joined here.
    const WITHIN: f64 = 1e-3;

    /// A sheet from one abscissa to another, so many cells wide and high.
    struct Sheet {
        from: f32,
        to: f32,
        columns: u32,
        rows: u32,
        bend: f32,
    }

    const WHOLE: Sheet = Sheet { from: 0.0, to: 1.0, columns: 8, rows: 6, bend: 0.3 };
    const LEFT: Sheet = Sheet { to: 0.5, columns: 4, ..WHOLE };
    const RIGHT: Sheet = Sheet { from: 0.5, columns: 4, ..WHOLE };

    impl Sheet {
        /// Its triangles, each of its vertices moved by what the row tells if it lies on its left border.
        fn triangles(&self, aside: impl Fn(u32) -> Vec3) -> Vec<[Vec3; 3]> {
            let &Self { from, to, columns, rows, bend } = self;
            let at = |column: u32, row: u32| {
                let x = from + (to - from) * column as f32 / columns as f32;
                let y = row as f32 / rows as f32;
                let aside = if column == 0 { aside(row) } else { Vec3::ZERO };
                Vec3::new(x, y, bend * y * y) + aside
            };
            let cell = |n: u32| {
                let (i, j) = (n % columns, n / columns);
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                [[a, b, c], [a, c, d]]
            };
            (0..columns * rows).flat_map(cell).collect()
        }
    }

    fn stays(_: u32) -> Vec3 {
        Vec3::ZERO
    }

    fn welded(parts: &[Vec<[Vec3; 3]>]) -> Welded {
        let positions: Vec<Vec3> = parts.concat().concat();
        let triangles = (0..positions.len() as u32 / 3).map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect();
        weld(&Mesh { vertices: Cloud { positions, ..Cloud::default() }, triangles, ..Mesh::default() })
    }

    /// Sewn from these halves, and what was sewn: no triangle is lost, and no border is left but that of the whole.
    fn closed(whole: &Sheet, halves: &[Vec<[Vec3; 3]>]) -> (Welded, Sewn) {
        let whole = Extent::of(&welded(&[whole.triangles(stays)])).length;
        let mut welded = welded(halves);
        let sewn = sew(&mut welded, WITHIN);
        let Extent { length, loops } = Extent::of(&welded);
        assert_eq!(loops, 1);
        assert!((length - whole).abs() < 1e-3 * whole, "{length} of {whole}");
        (welded, sewn)
    }

    /// That these parts stay as they are.
    fn stay_apart(parts: &[Vec<[Vec3; 3]>]) {
        let before = welded(parts);
        let mut after = before.clone();
        assert_eq!(sew(&mut after, WITHIN), Sewn::default());
        assert_eq!((&after.positions, &after.triangles), (&before.positions, &before.triangles));
    }

    /// Up to so far to all sides, another way for each row.
    fn rough(by: f64) -> impl Fn(u32) -> Vec3 {
        move |row| {
            let (sin, cos) = libm::sincos(2.4 * f64::from(row));
            by as f32 * Vec3::new(cos as f32, 0.3, sin as f32)
        }
    }

    #[test]
    fn halves_whose_borders_nearly_meet_become_one() {
        let halves = [LEFT.triangles(stays), RIGHT.triangles(rough(0.5 * WITHIN))];
        let (welded, sewn) = closed(&WHOLE, &halves);
        assert_eq!(sewn.vertices, 7);
        assert!(sewn.moved > 0.4 * WITHIN && sewn.moved < WITHIN, "{sewn:?}");
        assert_eq!(welded.triangles.len(), halves.concat().len());
        // In whatever order.
        let [left, right] = halves;
        let (other, _) = closed(&WHOLE, &[right, left]);
        assert_eq!((welded.positions, welded.triangles), (other.positions, other.triangles));
    }

    #[test]
    fn sides_that_pass_vertices_across_are_split_there() {
        let flat = Sheet { bend: 0.0, ..WHOLE };
        let (left, right) = (Sheet { bend: 0.0, rows: 4, ..LEFT }, Sheet { bend: 0.0, ..RIGHT });
        let (welded, sewn) = closed(&flat, &[left.triangles(stays), right.triangles(stays)]);
        // Quarters meet sixths at the ends and in the middle: two of one and four of the other lie inside sides.
        assert_eq!(sewn.vertices, 2 + 4);
        assert!(sewn.moved < 1e-7, "{sewn:?}");
        assert_eq!(welded.triangles.len(), 2 * 4 * (4 + 6) + 6);
    }

    #[test]
    fn wide_gaps_and_sheets_back_to_back_stay() {
        stay_apart(&[LEFT.triangles(stays), RIGHT.triangles(rough(4.0 * WITHIN))]);
        let back = |corners: &[Vec3; 3]| [corners[0], corners[2], corners[1]];
        let front = WHOLE.triangles(stays);
        stay_apart(&[front.clone(), front.iter().map(back).collect()]);
    }

    #[test]
    fn a_crack_that_would_close_here_and_there_stays() {
        let here_and_there = |row: u32| Vec3::X * if row.is_multiple_of(2) { 0.5e-3 } else { 2e-3 };
        stay_apart(&[LEFT.triangles(stays), RIGHT.triangles(here_and_there)]);
    }

    #[test]
    fn pieces_smaller_than_cracks_are_wide_keep_all_triangles() {
        let small = |by: f32| WHOLE.triangles(stays).iter().map(|corners| corners.map(|p| by * p)).collect();
        for by in [1e-2, 1e-3, 1e-4] {
            let mut welded = welded(&[small(by), RIGHT.triangles(|_| Vec3::X)]);
            let count = welded.triangles.len();
            sew(&mut welded, WITHIN);
            assert!(welded.triangles.len() >= count, "{} of {count} at {by}", welded.triangles.len());
        }
    }
}
