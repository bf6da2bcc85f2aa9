//! The Voronoi cell of a point in its tangent plane, as far as it is of the point's own sheet.
//!
//! Every place of the cell has the point within the distance of the cell's farthest corner. Beside a feature line, where
//! the sheet ends, only that part of the cell counts that can be reached from the point without leaving the cell or
//! crossing the line: around the line's corners too, since what lies behind may be nearest to no point that sees it.

use glam::DVec2;

use super::nearest::NEAREST;

/// Most corners a cell can have: a square cut by every neighbour.
const CORNERS: usize = 4 + NEAREST;

/// Places as near as this share of what a hole is wide to its rim lie in it: rounding must not tell.
const ROUNDING: f64 = 1e-9;

/// Corners at a line are looked for inside of it by this share of what a hole is wide, so that the line itself does not
/// hide them: far more than rounding moves them, far less than anything stands for.
const INSIDE: f64 = 1e-6;

/// And by this share away from the ends of its pieces: much more than [`INSIDE`], so that in an acute corner of the sheet
/// they lie inside of the other piece too.
const FROM_END: f64 = 1e-3;

/// The Voronoi cell of the origin among sites in a plane.
#[derive(Clone, Copy, Debug)]
pub struct Cell {
    corners: [DVec2; CORNERS],
    count: usize,
    /// What lies as far as this belongs to a hole.
    reach: f64,
}

/// The corners of a cell, as far as they count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corners {
    /// Distance of the farthest from the cell's own point; `None` where none counts.
    pub farthest: Option<f64>,
    /// Whether some do not count: the cell goes on into a hole.
    pub open: bool,
}

/// A piece of a line at which the sheet of the origin ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Side {
    /// Where it runs from and to.
    pub ends: [DVec2; 2],
    /// Unit vector across it, into the sheet.
    pub inward: DVec2,
}

impl Cell {
    /// The cell among `sites`, the nearest first, within a square of half a side `reach`: what lies as far belongs to a
    /// hole.
    #[must_use]
    pub fn of(sites: &[DVec2], reach: f64) -> Self {
        let (mut cell, mut cut) = (&mut [DVec2::ZERO; CORNERS], &mut [DVec2::ZERO; CORNERS]);
        let mut count = 4;
        for (corner, (x, y)) in cell.iter_mut().zip([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]) {
            *corner = DVec2::new(x, y) * reach;
        }
        let (mut farthest, mut beyond) = (2.0 * reach * reach, [0.0; CORNERS]);
        for site in sites.iter().take(NEAREST) {
            // A site at more than twice the distance of every corner cuts none of them off.
            if site.length_squared() > 4.0 * farthest {
                continue;
            }
            // Places nearer to the site lie beyond the bisector, on its far side.
            for (beyond, corner) in beyond.iter_mut().zip(&cell[..count]) {
                *beyond = corner.dot(*site) - 0.5 * site.length_squared();
            }
            if beyond[..count].iter().all(|beyond| *beyond <= 0.0) {
                continue;
            }
            count = near_side(&cell[..count], &beyond, cut);
            std::mem::swap(&mut cell, &mut cut);
            farthest = cell[..count].iter().map(|corner| corner.length_squared()).fold(0.0, f64::max);
        }
        Self { corners: *cell, count, reach }
    }

    /// Its corners, as far as they count.
    #[must_use]
    pub fn whole(&self) -> Corners {
        self.counted(self.corners().iter().map(|corner| corner.length()))
    }

    /// The corners of the part of it around the origin that some sides leave, as far as they count.
    #[must_use]
    pub fn within(&self, sides: &[Side]) -> Corners {
        self.counted(self.reached(sides).iter().map(|corner| corner.length()))
    }

    /// Whether sides pass between the origin and some of the sites.
    #[must_use]
    pub fn parts(&self, sides: &[Side], sites: &[DVec2]) -> bool {
        let origin = self.inside(sides);
        sides.iter().any(|side| sites.iter().any(|&site| cross([origin, site], side.ends)))
    }

    /// The corners of the part of it around the origin that some sides leave.
    #[must_use]
    pub fn reached(&self, sides: &[Side]) -> Vec<DVec2> {
        let inside = sides.iter().filter_map(|side| self.ends_within(side)).flatten();
        let mut left: Vec<DVec2> = inside.chain(self.corners().iter().copied()).collect();
        let mut reached = vec![self.inside(sides)];
        let mut at = 0;
        while at < reached.len() {
            let from = reached[at];
            let sees = |to: &mut DVec2| !sides.iter().any(|side| cross([from, *to], side.ends));
            reached.extend(left.extract_if(.., sees));
            at += 1;
        }
        reached.split_off(1)
    }

    /// The place of the origin, but on the inner side of what it lies on, or across.
    fn inside(&self, sides: &[Side]) -> DVec2 {
        let least = INSIDE * self.reach;
        sides.iter().fold(DVec2::ZERO, |place, side| {
            let off = (place - side.ends[0]).dot(side.inward);
            if off < least && side.is_beside(place) { place + (least - off) * side.inward } else { place }
        })
    }

    /// The ends of what lies in the cell of a side, a little inside.
    fn ends_within(&self, side: &Side) -> Option<[DVec2; 2]> {
        let [from, to] = side.ends;
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        for [a, b] in self.edges() {
            let out = -(b - a).perp();
            let (before, after) = ((from - a).dot(out), (to - a).dot(out));
            match (before > 0.0, after > 0.0) {
                (true, true) => return None,
                (true, false) => enter = enter.max(before / (before - after)),
                (false, true) => leave = leave.min(before / (before - after)),
                (false, false) => {}
            }
        }
        let least = (FROM_END * self.reach / from.distance(to)).min(0.25 * (leave - enter));
        let place = |share: f64| from.lerp(to, share) + INSIDE * self.reach * side.inward;
        (enter < leave).then(|| [place(enter + least), place(leave - least)])
    }

    fn corners(&self) -> &[DVec2] {
        &self.corners[..self.count]
    }

    fn edges(&self) -> impl Iterator<Item = [DVec2; 2]> + '_ {
        (0..self.count).map(|n| [self.corners[n], self.corners[(n + 1) % self.count]])
    }

    fn counted(&self, distances: impl Iterator<Item = f64>) -> Corners {
        let mut counted = Corners { farthest: None, open: false };
        for distance in distances {
            // Corners of the square itself, or on its sides, lie at least `reach` away.
            if distance >= self.reach * (1.0 - ROUNDING) {
                counted.open = true;
            } else if distance > 0.0 {
                counted.farthest = Some(counted.farthest.map_or(distance, |far| far.max(distance)));
            }
        }
        counted
    }
}

impl Side {
    /// Whether a place lies beside it, not beyond its ends.
    fn is_beside(&self, place: DVec2) -> bool {
        let along = self.ends[1] - self.ends[0];
        (0.0..=along.length_squared()).contains(&(place - self.ends[0]).dot(along))
    }
}

/// Whether two straight ways cross.
fn cross([a, b]: [DVec2; 2], [from, to]: [DVec2; 2]) -> bool {
    let (way, along) = (b - a, to - from);
    let turn = way.perp_dot(along);
    let (share, other) = ((from - a).perp_dot(along) / turn, (from - a).perp_dot(way) / turn);
    (0.0..=1.0).contains(&share) && (0.0..=1.0).contains(&other)
}

/// The part of a cell this side of a line, by how far its corners lie beyond it; how many corners that has.
fn near_side(cell: &[DVec2], beyond: &[f64], part: &mut [DVec2; CORNERS]) -> usize {
    let mut kept = 0;
    for n in 0..cell.len() {
        let next = if n + 1 < cell.len() { n + 1 } else { 0 };
        let (fa, fb) = (beyond[n], beyond[next]);
        if fa <= 0.0 && kept < CORNERS {
            part[kept] = cell[n];
            kept += 1;
        }
        if (fa < 0.0) != (fb < 0.0) && kept < CORNERS {
            part[kept] = cell[n].lerp(cell[next], fa / (fa - fb));
            kept += 1;
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::analyse::cloud_normals::NormalSource;
    use crate::analyse::cloud_surface::{Lines, cloud_discs};
    use crate::analyse::planted::random;
    use crate::model::cloud::Cloud;
    use glam::{DVec3, Vec3};

    #[test]
    fn corners_of_planted_cells() {
        let square: Vec<DVec2> = [(1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, 1)]
            .map(|(x, y)| DVec2::new(x.into(), y.into()))
            .to_vec();
        let corner = |sites: &[DVec2]| Cell::of(sites, 2.5).whole().farthest;
        let open = |sites: &[DVec2]| Cell::of(sites, 2.5).whole().open;
        assert!((corner(&square).unwrap() - std::f64::consts::FRAC_1_SQRT_2).abs() < 1e-12);
        let hexagon: Vec<DVec2> =
            (0..6).map(|n| DVec2::from_angle(f64::from(n) * std::f64::consts::FRAC_PI_3)).collect();
        assert!((corner(&hexagon).unwrap() - 1.0 / 3.0_f64.sqrt()).abs() < 1e-12);
        // At the border of a lattice only the corners on the inner side count.
        assert!(
            (corner(&[DVec2::X, DVec2::Y, -DVec2::X]).unwrap() - std::f64::consts::FRAC_1_SQRT_2).abs()
                < 1e-12
        );
        assert_eq!(corner(&[DVec2::X, -DVec2::X]), None, "a line of points bounds no cell");
        assert_eq!(corner(&[]), None);
        assert!(!open(&square) && !open(&hexagon) && open(&hexagon[..3]) && open(&[]));
    }

    #[test]
    fn a_cell_ends_at_lines_and_goes_on_around_their_corners() {
        let places = |places: &[[f64; 2]]| places.iter().map(|&place| DVec2::from(place)).collect::<Vec<_>>();
        let cell = Cell::of(&places(&[[-1.0, 0.0], [0.0, 1.0], [0.0, -1.0], [4.0, 0.0]]), 2.5);
        let side = |ends: [[f64; 2]; 2], inward: DVec2| Side { ends: ends.map(DVec2::from), inward };
        let wall = side([[0.3, -3.0], [0.3, 3.0]], DVec2::NEG_X);
        let half = std::f64::consts::FRAC_1_SQRT_2;
        assert!((cell.whole().farthest.unwrap() - 4.25_f64.sqrt()).abs() < 1e-12);
        assert!((cell.within(&[wall]).farthest.unwrap() - half).abs() < 1e-12);
        assert!(cell.parts(&[wall], &[DVec2::NEG_X, DVec2::X]) && !cell.parts(&[wall], &[DVec2::NEG_X]));
        let corner =
            [side([[0.3, -3.0], [0.3, 0.2]], DVec2::NEG_X), side([[0.3, 0.2], [3.0, 0.2]], DVec2::Y)];
        let reached = cell.reached(&corner);
        let holds = |place: [f64; 2]| reached.iter().any(|at| at.distance(DVec2::from(place)) < 0.01);
        for within in [[-0.5, 0.5], [-0.5, -0.5], [0.3, -0.5], [0.3, 0.2], [2.0, 0.2], [2.0, 0.5]] {
            assert!(holds(within), "{within:?} of {reached:?}");
        }
        assert!(!holds([2.0, -0.5]), "{reached:?}");
        let open = Cell::of(&places(&[[-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]]), 2.5);
        assert!(open.whole().open && !open.within(&[wall]).open);
        let across = side([[-0.1, -3.0], [-0.1, 3.0]], DVec2::NEG_X);
        assert!((cell.within(&[across]).farthest.unwrap() - half).abs() < 1e-12, "from across the line");
    }

    /// Points of a floor over `[-0.5, 0.5]²` around a pit, and their margins.
    fn floor_around(rim: &[DVec2], is_pit: &impl Fn(DVec2) -> bool) -> Vec<(DVec2, f64)> {
        let on_wall = |n: u64| {
            let at = n as usize % rim.len();
            let place = rim[at].lerp(rim[(at + 1) % rim.len()], 0.5 + 0.5 * random(7 * n));
            place.extend(-0.25 - 0.25 * random(7 * n + 1))
        };
        let floor = (0..4000).map(place).filter(|&place| !is_pit(place)).map(|place| place.extend(0.0));
        let positions: Vec<Vec3> =
            floor.chain((50_000..51_000).map(on_wall)).map(|place| place.as_vec3()).collect();
        let line: Vec<DVec3> = rim.iter().chain(rim.first()).map(|place| place.extend(0.0)).collect();
        let cloud = Cloud { positions, ..Cloud::default() };
        let discs = cloud_discs(&cloud, NormalSource::Estimate, Lines::Given(&[line]), None).unwrap().discs;
        let points = cloud.positions.iter().zip(discs.all());
        let floor = points.filter(|(position, _)| position.z == 0.0);
        floor.map(|(position, disc)| (position.as_dvec3().truncate(), f64::from(disc.margin))).collect()
    }

    fn place(n: u64) -> DVec2 {
        DVec2::new(0.5 * random(2 * n), 0.5 * random(2 * n + 1))
    }

    #[test]
    fn margins_fill_a_sheet_up_to_its_lines_and_go_little_farther() {
        let fills = |rim: &[DVec2], is_pit: &dyn Fn(DVec2) -> bool| {
            let floor = floor_around(rim, &is_pit);
            for place in (100_000..130_000).map(place).filter(|place| place.abs().max_element() < 0.4) {
                let is_near = |(at, margin): &(DVec2, f64)| at.distance(place) <= 1.0001 * margin;
                assert!(is_pit(place) || floor.iter().any(is_near), "{place}");
            }
            let mean = |beside: bool| {
                let is_beside = |at: DVec2| rim.iter().any(|corner| corner.distance(at) < 0.02);
                let inner = floor.iter().filter(|(at, _)| at.abs().max_element() < 0.4);
                let these = inner.filter(|(at, _)| is_beside(*at) == beside).map(|(_, margin)| margin);
                these.clone().sum::<f64>() / these.count() as f64
            };
            assert!(mean(true) < 1.1 * mean(false), "{} beside the line, {} off it", mean(true), mean(false));
        };
        let round: Vec<DVec2> =
            (0..64).map(|n| 0.2 * DVec2::from_angle(f64::from(n) * std::f64::consts::TAU / 64.0)).collect();
        fills(&round, &|place| place.length() < 0.2 * libm::cos(std::f64::consts::PI / 64.0));
        let corner = |n: usize| DVec2::from([[0.2, 0.0], [0.0, 0.2], [-0.2, 0.0], [0.0, -0.2]][n % 4]);
        let square: Vec<DVec2> =
            (0..40).map(|n| corner(n / 10).lerp(corner(n / 10 + 1), (n % 10) as f64 / 10.0)).collect();
        fills(&square, &|place| place.abs().element_sum() < 0.2);
    }
}
