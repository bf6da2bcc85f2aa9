//! Where splats begin to grow over a piece: poses, each with radii.

use glam::{DVec2, DVec3};

use super::grow::Grower;
use super::shaped::Shaped;
use crate::fit::ellipse::circumellipse;
use crate::fit::pose::Pose;

/// The least domain around a point of a cloud, in the point's margins: it must reach beyond
/// one to cover the point.
const LEAST_MARGINS: f64 = 1.2;

/// The least domain around a triangle goes on beyond its corners by this factor: they must lie
/// inside whatever is rounded.
const LEAST_OUTSET: f64 = 1.01;

/// The least radius worth trying, as a share of the budget, however small the piece.
const LEAST_SHARE: f64 = 0.02;

/// Least radii, in budgets for fits, of ellipses along a sliver where narrower ones fail: the few places that those
/// reach say nothing of the way the surface tilts, and a rounded edge narrower than the budget, of slivers side by
/// side, can be reached over as a whole. With these the trunk of a robot, whose screws have such edges, takes 22 %
/// fewer bytes.
const BROAD: [f64; 3] = [1.0, 0.5, 0.25];

/// A piece as its splats begin.
pub(super) struct Starts {
    /// At its middle.
    pose: Pose,
    /// How far its corners lie from there, or the point of a cloud that stands for it; 0 for one that stands for
    /// itself.
    reach: f64,
    /// The turn of the least ellipse around it, from the pose's axes.
    turn: f64,
    /// The radii of that ellipse.
    radii: DVec2,
    /// What a point beside a line stands for.
    cell: Option<Shaped>,
    /// No radius is less.
    floor: f64,
    /// The budget for fits.
    fit: f64,
}

impl Starts {
    pub(super) fn of(grower: &Grower, piece: u32) -> Self {
        let surface = grower.surface;
        let corners = surface.pieces[piece as usize];
        let normal: DVec3 = corners.iter().map(|&corner| surface.normal(corner)).sum();
        let pose = Pose::at(surface.middle(piece), normal);
        let flat = corners.map(|corner| pose.to_local(surface.point(corner)).truncate());
        let cell = Shaped::over(surface, piece, &pose);
        let reach = flat.iter().map(|uv| uv.length()).fold(0.0, f64::max);
        let (turn, radii) = circumellipse(flat);
        let fit = grower.budget.fit;
        let floor = (LEAST_MARGINS * surface.piece_margin(piece)).max(LEAST_SHARE * fit);
        Self { pose, reach, turn, radii, cell, floor, fit }
    }

    /// The least radii worth trying: first of a disc, then, but for a lone point, of an ellipse as slender as the piece
    /// is, or as what a point beside a line stands for. Beside a fold the disc may be too wide.
    pub(super) fn least(&self) -> impl Iterator<Item = (Pose, DVec2)> + use<> {
        let slender = self.is_extended().then(|| self.slender());
        let least = LEAST_SHARE * self.fit;
        let cell =
            self.cell.as_ref().map(|cell| (cell.pose, (LEAST_MARGINS * cell.radii).max(DVec2::splat(least))));
        std::iter::once((self.pose, self.outset(DVec2::splat(self.reach)))).chain(cell).chain(slender)
    }

    /// Ellipses along a piece that are broader than it.
    pub(super) fn broad(&self) -> impl Iterator<Item = (Pose, DVec2)> + use<> {
        let (pose, slender) = self.slender();
        let breadths =
            if self.is_extended() { BROAD.map(|breadth| breadth * self.fit).to_vec() } else { Vec::new() };
        let broader = breadths.into_iter().filter(move |&breadth| breadth > slender.min_element());
        broader.map(move |breadth| (pose, slender.max(DVec2::splat(breadth))))
    }

    fn is_extended(&self) -> bool {
        self.reach > 0.0
    }

    fn slender(&self) -> (Pose, DVec2) {
        (self.pose.turned(self.turn), self.outset(self.radii))
    }

    fn outset(&self, radii: DVec2) -> DVec2 {
        (LEAST_OUTSET * radii).max(DVec2::splat(self.floor))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analyse::split::split;
    use crate::analyse::weld::Welded;
    use crate::fit::clip::Clips;
    use crate::model::splat::Splat;
    use crate::sample::budget::Budget;
    use crate::sample::candidates::{Regions, candidates};
    use crate::sample::cover::cover;
    use crate::sample::scout::Begun;
    use glam::Vec3;

    /// Slivers side by side around the rounded edge.
    const SLIVERS: u32 = 8;

    #[test]
    fn an_edge_rounded_more_narrowly_than_the_budget_takes_few_last_resorts() {
        let (bound, radius, wide, long) = (0.02_f32, 0.006_f32, 0.3_f32, 0.25_f32);
        // Across the edge: a floor, a quarter of a circle, a wall.
        let arc = (0..=SLIVERS).map(|n| {
            let (sin, cos) = libm::sincos(f64::from(n) / f64::from(SLIVERS) * std::f64::consts::FRAC_PI_2);
            [radius * (sin as f32 - 1.0), radius * (cos as f32 - 1.0)]
        });
        let across: Vec<[f32; 2]> =
            std::iter::once([-wide, 0.0]).chain(arc).chain(std::iter::once([0.0, -wide])).collect();
        let count = across.len() as u32;
        let at = |y: f32| across.iter().map(move |&[x, z]| Vec3::new(x, y, z));
        let positions: Vec<Vec3> = at(0.0).chain(at(long)).collect();
        let cells = (0..count - 1).flat_map(|n| [[n, n + 1, n + count], [n + 1, n + count + 1, n + count]]);
        let welded = Welded { positions, triangles: cells.collect(), ..Welded::default() };
        let surface = split(&welded, &vec![false; 3 * welded.triangles.len()]);
        let round = |splat: &Splat, _: u8| Some(splat.clone());
        let grower = Grower::new(&surface, Budget::new(f64::from(bound), Clips::Curved), &round);
        let regions = Regions::new(surface.points.len());
        let grown = candidates(&grower, &regions, &Begun::default(), 1, |_| ());
        let (_, choice) = cover(&grower, &regions, grown, 1);
        // From slender ellipses alone all but one of its pieces take one.
        assert!(choice.last_resorts < SLIVERS as usize && choice.uncovered == 0, "{choice:?}");
    }
}
