//! The surface of a cloud, over those of its points that stand for all.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::line_cut::{LineCut, LinePoint};
use super::surface::{Cells, NONE, Rows, Spot, Surface, inverse};
use super::thin::Sheet;

/// A cloud and what stands for what in it.
///
/// Rows are first the points that stand for others, or for themselves alone, in the order of the
/// cloud, then the points on lines.
pub(super) struct Assembly<'a> {
    sheet: &'a Sheet<'a>,
    colors: &'a [[u8; 3]],
    cut: Option<&'a LineCut>,
    /// The points of the rows.
    kept: Vec<u32>,
    /// For each point the row that stands for it, or [`NONE`].
    row_of: Vec<u32>,
    /// For each of those rows, the points that it stands for.
    owned: Rows,
}

impl<'a> Assembly<'a> {
    /// `owner` tells for each point the one that stands for it, or [`NONE`].
    pub(super) fn new(
        sheet: &'a Sheet<'a>,
        colors: &'a [[u8; 3]],
        owner: &[u32],
        cut: Option<&'a LineCut>,
    ) -> Self {
        let kept: Vec<u32> = (0..owner.len() as u32).filter(|&n| owner[n as usize] == n).collect();
        let mut row_of = vec![NONE; owner.len()];
        for (row, &point) in (0_u32..).zip(&kept) {
            row_of[point as usize] = row;
        }
        for (point, &by) in owner.iter().enumerate().filter(|&(_, &by)| by != NONE) {
            row_of[point] = row_of[by as usize];
        }
        let owned = Rows::grouped(kept.len(), &row_of);
        Self { sheet, colors, cut, kept, row_of, owned }
    }

    /// The surface; `joins` are pairs of a point on a line and one of the cloud.
    pub(super) fn surface(&self, joins: Vec<(u32, u32)>) -> Surface {
        let on_lines = self.on_lines();
        let rows = || 0..self.kept.len() as u32;
        let of_lines = |more: fn(&LinePoint) -> Vec3| on_lines.par_iter().map(more);
        let border_next = self.border_next();
        let lengths = rows().map(|row| self.owned.row(row).len() as u32).chain(on_lines.iter().map(|_| 0));
        Surface {
            points: rows()
                .into_par_iter()
                .map(|row| self.middle(row))
                .chain(of_lines(|p| p.position))
                .collect(),
            places: rows().chain(on_lines.iter().map(|point| self.count() + point.node)).collect(),
            normals: self.kept.par_iter().map(|&n| self.normal(n)).chain(of_lines(|p| p.normal)).collect(),
            colors: self.mean_colors(),
            neighbours: self.neighbours(joins),
            pieces: rows().flat_map(|row| self.owned.row(row).iter().map(move |_| [row; 3])).collect(),
            spots: rows().flat_map(|row| self.owned.row(row)).map(|&point| self.spot(point)).collect(),
            cells: self.cells(),
            pieces_of: Rows::consecutive(&lengths.collect::<Vec<_>>()),
            margin: rows()
                .into_par_iter()
                .map(|row| self.margin(row))
                .chain(on_lines.par_iter().map(|_| 0.0))
                .collect(),
            border_prev: inverse(&border_next),
            border_next,
            carried: self.carried(),
        }
    }

    fn count(&self) -> u32 {
        self.kept.len() as u32
    }

    fn on_lines(&self) -> &[LinePoint] {
        self.cut.map(|cut| cut.points.as_slice()).unwrap_or_default()
    }

    fn point(&self, point: u32) -> DVec3 {
        self.sheet.positions[point as usize].as_dvec3()
    }

    fn normal(&self, point: u32) -> Vec3 {
        self.sheet.normals[point as usize]
    }

    fn spot(&self, point: u32) -> Spot {
        let (position, joined) = (self.sheet.positions[point as usize], &self.sheet.joined[point as usize]);
        Spot { position, margin: joined.margin }
    }

    /// What lines bound of that for which spots stand.
    fn cells(&self) -> Cells {
        let all = self.sheet.cells;
        let spots = (0..self.count()).flat_map(|row| self.owned.row(row));
        Cells::new(spots.map(|point| {
            let found = all.binary_search_by_key(point, |cell| cell.0);
            found.map(|at| all[at].1.as_slice()).unwrap_or_default()
        }))
    }

    /// A row's point, moved along its normal to the mean height of those it stands for: their noise
    /// is averaged, and the spread of the points stays even.
    fn middle(&self, row: u32) -> Vec3 {
        let (point, owned) = (self.kept[row as usize], self.owned.row(row));
        let (center, normal) = (self.point(point), self.normal(point).as_dvec3());
        let heights: f64 = owned.iter().map(|&other| (self.point(other) - center).dot(normal)).sum();
        (center + heights / owned.len() as f64 * normal).as_vec3()
    }

    /// How far a row stands for the surface: to the far side of the farthest point it stands for.
    fn margin(&self, row: u32) -> f32 {
        let center = self.point(self.kept[row as usize]);
        let far = |&other: &u32| self.point(other).distance(center) as f32 + self.spot(other).margin;
        self.owned.row(row).iter().map(far).fold(0.0, f32::max)
    }

    /// Rows joined where points are that they stand for, and to those on lines.
    fn neighbours(&self, mut joins: Vec<(u32, u32)>) -> Rows {
        let (count, on_lines) = (self.count(), self.on_lines());
        joins.retain_mut(|(_, point)| {
            *point = self.row_of[*point as usize];
            *point != NONE
        });
        let sides = self.cut.into_iter().flat_map(LineCut::sides);
        joins.extend(sides.map(|(from, to)| (from, count + to)));
        let from_lines = Rows::from_pairs(on_lines.len(), joins);
        let rows = count + on_lines.len() as u32;
        let listed = Rows::built(rows, |row, list| {
            if row >= count {
                return list.extend(from_lines.row(row - count));
            }
            let sectors = |&point: &u32| self.sheet.joined[point as usize].sectors;
            let around = self.owned.row(row).iter().flat_map(sectors).filter(|&other| other != NONE);
            let others = around.map(|other| self.row_of[other as usize]);
            list.extend(others.filter(|&other| other != NONE && other != row));
        });
        Rows::symmetric(rows, |row| listed.row(row).iter().copied())
    }

    /// For each row the next one along a line.
    fn border_next(&self) -> Vec<u32> {
        let mut next = vec![NONE; self.kept.len() + self.on_lines().len()];
        for (from, to) in self.cut.into_iter().flat_map(LineCut::sides) {
            next[(self.count() + from) as usize] = self.count() + to;
        }
        next
    }

    /// For each row whether the side of a border that starts there only carries a line on beyond its end.
    fn carried(&self) -> Vec<bool> {
        let Some(cut) = self.cut else { return Vec::new() };
        let mut carried = vec![false; self.kept.len() + cut.points.len()];
        for ((from, _), is_carried) in cut.sides().zip(cut.carried()) {
            carried[(self.count() + from) as usize] = is_carried;
        }
        carried
    }

    fn mean_colors(&self) -> Vec<[u8; 3]> {
        if self.colors.is_empty() {
            return Vec::new();
        }
        let like = |point: &LinePoint| self.colors[point.like as usize];
        let rows = (0..self.count()).map(|row| self.mean_color(self.owned.row(row)));
        rows.chain(self.on_lines().iter().map(like)).collect()
    }

    fn mean_color(&self, owned: &[u32]) -> [u8; 3] {
        let mut sums = [0_u64; 3];
        for &point in owned {
            for (sum, channel) in sums.iter_mut().zip(self.colors[point as usize]) {
                *sum += u64::from(channel);
            }
        }
        let count = owned.len() as u64;
        sums.map(|sum| ((sum + count / 2) / count) as u8)
    }
}
