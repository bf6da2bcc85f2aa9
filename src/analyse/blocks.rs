//! The nearest points of many at once.
//!
//! Points that lie together ask together: those of a cell of an octree share the points of the
//! twenty-seven cells around, and each finds its nearest by going through them, one after another
//! in memory. A k-d tree descends from its root for each point anew: for 4 million points of a
//! surface on 2 threads that takes twice as long. The tree still answers for points whose
//! nearest may lie beyond those cells.

use std::ops::Range;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::canonical::{MORTON_LEVELS, MORTON_UNIT, morton};
use super::nearest::{ASKED, NEAREST, Nearest, Search, chosen};
use super::surface::NONE;

/// A cell of no more points than this is not divided: a surface that runs through it leaves some
/// eight in each of four parts, and the sixteen nearest then lie no farther than a cell is wide.
const FEW: usize = 32;

/// Cells among more points than this are left to the tree: they lie beside denser ones.
const MANY: usize = 2048;

/// Parts of the cloud with more points are divided among the threads.
const SHARED: usize = 1 << 14;

/// The next point's nearest are first sought among those within this many times the square of the
/// distance at which the last point's ended.
const WIDER: f32 = 1.5;

/// Of a distance to the side of the cells around, the share that rounding leaves sure.
const SURE: f64 = 1.0 - 1e-6;

/// Cells around one, itself among them.
const AROUND: usize = 27;

/// Itself among those around.
const OWN: usize = 13;

/// Points along the Morton curve, with their codes.
pub(super) struct Blocks<'a> {
    codes: Vec<u64>,
    points: &'a [[f32; 3]],
    search: &'a Search,
}

/// A cell, and the points of all cells of its size around it, row by row along x, y, z.
#[derive(Clone)]
struct Cell {
    level: u32,
    around: [Range<usize>; AROUND],
}

/// Points side by side, to be gone through fast; reused from cell to cell.
#[derive(Default)]
struct Candidates {
    numbers: Vec<u32>,
    places: [Vec<f32>; 3],
    squares: Vec<f32>,
    /// The squares of distances, as the bits of positive floats, and below them the numbers.
    found: Vec<u64>,
}

impl<'a> Blocks<'a> {
    /// Blocks over the points of a search; `None` if these do not lie along the Morton curve.
    pub(super) fn new(points: &'a [[f32; 3]], search: &'a Search) -> Option<Self> {
        let codes: Vec<u64> = points.par_iter().map(|&p| morton(Vec3::from(p))).collect();
        codes.is_sorted().then_some(Self { codes, points, search })
    }

    /// The nearest others of each point.
    pub(super) fn nearest(&self) -> Nearest {
        let mut rows = vec![[NONE; NEAREST]; self.points.len()];
        let around = std::array::from_fn(|n| if n == OWN { 0..self.points.len() } else { 0..0 });
        self.descend(&Cell { level: 0, around }, &mut rows, &mut Candidates::default());
        rows
    }

    /// Fills the rows of a cell's points.
    fn descend(&self, cell: &Cell, rows: &mut [[u32; NEAREST]], candidates: &mut Candidates) {
        if rows.is_empty() {
            return;
        }
        if rows.len() <= FEW || cell.level == MORTON_LEVELS {
            return self.fill(cell, rows, candidates);
        }
        let shared = rows.len() > SHARED;
        let mut rest = rows;
        let parts = cell.divided(self).map(|part| {
            let (own, others) = std::mem::take(&mut rest).split_at_mut(part.own().len());
            rest = others;
            (part, own)
        });
        if shared {
            let shares = parts.into_par_iter();
            shares.for_each_init(Candidates::default, |own, (part, rows)| self.descend(&part, rows, own));
        } else {
            parts.into_iter().for_each(|(part, rows)| self.descend(&part, rows, candidates));
        }
    }

    /// Fills the rows of a cell that is not divided.
    fn fill(&self, cell: &Cell, rows: &mut [[u32; NEAREST]], candidates: &mut Candidates) {
        let count: usize = cell.around.iter().map(ExactSizeIterator::len).sum();
        let numbered = rows.iter_mut().zip(cell.own().start as u32..);
        if !(ASKED..=MANY).contains(&count) {
            return numbered.for_each(|(row, number)| *row = self.search.others(number));
        }
        candidates.fill(self.points, &cell.around);
        let mut limit = f32::INFINITY;
        for (row, number) in numbered {
            let point = self.points[number as usize];
            let (farthest, nearest) = candidates.nearest(point, limit);
            limit = WIDER * farthest;
            let inside = SURE * self.inside(cell.level, point);
            *row = if f64::from(farthest) < inside * inside {
                chosen(self.points, number, nearest)
            } else {
                self.search.others(number)
            };
        }
    }

    /// Where the eighths of a cell begin among its points, and the last ends.
    fn eighths(&self, level: u32, cell: &Range<usize>) -> [usize; 9] {
        let shift = 3 * (MORTON_LEVELS - 1 - level);
        let codes = &self.codes[cell.clone()];
        std::array::from_fn(|eighth| match eighth {
            8 => cell.end,
            _ => cell.start + codes.partition_point(|code| ((code >> shift) & 7) < eighth as u64),
        })
    }

    /// How far a point of a cell lies from the side of the cells around, model units.
    fn inside(&self, level: u32, point: [f32; 3]) -> f64 {
        let width = MORTON_UNIT * f64::from(1_u32 << (MORTON_LEVELS - level));
        let place = (Vec3::from(point).as_dvec3() + DVec3::ONE) / width;
        let within = place - place.floor();
        width * (1.0 + within.min(DVec3::ONE - within).min_element())
    }
}

impl Cell {
    fn own(&self) -> Range<usize> {
        self.around[OWN].clone()
    }

    /// Its eighths, in the order of the curve, with what lies around each.
    fn divided(&self, blocks: &Blocks<'_>) -> [Self; 8] {
        let eighths = self.around.clone().map(|cell| blocks.eighths(self.level, &cell));
        std::array::from_fn(|eighth| {
            let own = [eighth & 1, eighth >> 1 & 1, eighth >> 2];
            let around = std::array::from_fn(|n| {
                // Steps of -1, 0 or 1 from this eighth, in eighths counted from the first cell around.
                let step = [n % 3, n / 3 % 3, n / 9];
                let at: [usize; 3] = std::array::from_fn(|axis| own[axis] + step[axis] + 1);
                let cell = at[0] / 2 + 3 * (at[1] / 2) + 9 * (at[2] / 2);
                let part = at[0] % 2 + 2 * (at[1] % 2) + 4 * (at[2] % 2);
                eighths[cell][part]..eighths[cell][part + 1]
            });
            Self { level: self.level + 1, around }
        })
    }
}

impl Candidates {
    /// Takes the points of some cells.
    fn fill(&mut self, points: &[[f32; 3]], cells: &[Range<usize>]) {
        self.numbers.clear();
        self.places.iter_mut().for_each(Vec::clear);
        for cell in cells.iter().filter(|cell| !cell.is_empty()) {
            self.numbers.extend(cell.start as u32..cell.end as u32);
            for (axis, along) in self.places.iter_mut().enumerate() {
                along.extend(points[cell.clone()].iter().map(|point| point[axis]));
            }
        }
        self.squares.resize(self.numbers.len(), 0.0);
        self.found.resize(self.numbers.len() + 1, 0);
    }

    /// Finds the [`ASKED`] nearest to a place, of no fewer, nearest first; `limit` is a guess of the
    /// farthest one's squared distance, which comes with them.
    fn nearest(&mut self, [x, y, z]: [f32; 3], limit: f32) -> (f32, impl Iterator<Item = u32> + '_) {
        let [xs, ys, zs] = &self.places;
        for (square, ((a, b), c)) in self.squares.iter_mut().zip(xs.iter().zip(ys).zip(zs)) {
            let (dx, dy, dz) = (a - x, b - y, c - z);
            *square = dx * dx + dy * dy + dz * dz;
        }
        let mut count = self.within(limit);
        if count < ASKED {
            count = self.within(f32::INFINITY);
            // Of so many, only the nearest are worth sorting.
            self.found[..count].select_nth_unstable(ASKED - 1);
            count = ASKED;
        }
        self.found[..count].sort_unstable();
        let nearest = &self.found[..ASKED];
        (f32::from_bits((nearest[ASKED - 1] >> 32) as u32), nearest.iter().map(|&found| found as u32))
    }

    /// Notes all within a squared distance; how many.
    fn within(&mut self, limit: f32) -> usize {
        let mut count = 0;
        for (square, &number) in self.squares.iter().zip(&self.numbers) {
            // Whether it counts or not, so that nothing has to be foreseen.
            self.found[count] = u64::from(square.to_bits()) << 32 | u64::from(number);
            count += usize::from(*square <= limit);
        }
        count
    }
}
