//! A cloud's surface: a disc around each of its points, in the plane that touches the surface there.
//!
//! Each reaches as far as its point stands for the surface, so that together they fill it; holes larger
//! than that stay. A disc ends where a feature line does: what lies across is of another sheet.

use glam::{DVec3, Vec3};

use super::frame::Frame;

/// A disc around a point of a cloud.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Disc {
    /// Unit normal of its plane, outward as far as can be told. Zero where nothing is known of it: such a
    /// disc faces whoever looks at it.
    pub normal: Vec3,
    /// Its radius: how far the point stands for the surface, model units.
    pub margin: f32,
    /// By how much the surface's normal turns at most on the way from this point to the rim or to the points
    /// around it: the distance between the two unit vectors.
    pub turn: f32,
    /// Whether the points around leave it open how far the surface goes on, as at a border they do.
    pub open: bool,
    /// Where there are no points around, as beyond a border.
    pub gap: Option<Gap>,
}

/// A wedge of a disc, with its tip at the point, toward which there is no other point of the sheet: the
/// surface may end at the point itself or go on to the rim.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// Unit vector along its middle.
    pub outward: Vec3,
    /// Cosine of half its angle.
    pub cosine: f32,
}

impl Gap {
    /// Whether a place lies in it, `way` from the disc's point.
    #[must_use]
    pub fn holds(&self, way: DVec3) -> bool {
        way.dot(self.outward.as_dvec3()) > f64::from(self.cosine) * way.length()
    }
}

/// Where an open disc may really end, in its margins. How far beyond its last points a cloud's surface goes
/// on is known to within one margin: at least as far as they stand for it.
const OPEN_REACH: f32 = 2.0;

impl Disc {
    /// How far from the point the surface may reach, model units.
    #[must_use]
    pub fn reach(&self) -> f32 {
        if self.open { OPEN_REACH * self.margin } else { self.margin }
    }

    /// How far the surface may lie from the disc's plane, model units: a disc of radius `r` that touches a
    /// sphere along which normals turn by `t` on the way to its rim is off by `r t / 2` there.
    #[must_use]
    pub fn sagitta(&self) -> f32 {
        0.5 * self.margin * self.turn
    }
}

/// A piece of a feature line that ends a disc, laid into the disc's plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct End {
    /// Where it runs from and to, model units.
    pub ends: [Vec3; 2],
    /// Unit vector across it, to the side of the disc's own sheet.
    pub inward: Vec3,
}

impl End {
    /// The share of the straight `way` from a disc's `center` to a place in its plane after which it leaves
    /// the sheet here; `None` if it does not.
    ///
    /// From a center that noise has put across the line it leaves at once.
    #[must_use]
    pub fn crossed(&self, center: DVec3, way: DVec3) -> Option<f64> {
        let [from, to] = self.ends.map(|end| end.as_dvec3() - center);
        let inward = self.inward.as_dvec3();
        let (before, after) = (-from.dot(inward), (way - from).dot(inward));
        if after >= 0.0 {
            return None;
        }
        let share = if before > 0.0 { before / (before - after) } else { 0.0 };
        let at = if before > 0.0 { share * way } else { way };
        let along = to - from;
        (0.0..=along.length_squared()).contains(&(at - from).dot(along)).then_some(share)
    }
}

/// The discs of a cloud, one a point in the cloud's order, and what ends them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Discs {
    discs: Vec<Disc>,
    /// Where the ends of each disc begin among all, and the last's end; empty where nothing ends any.
    starts: Vec<u32>,
    ends: Vec<End>,
}

impl Discs {
    /// Discs, each with the ends that are given with its number; these ascend.
    #[must_use]
    pub fn new(discs: Vec<Disc>, ends: &[(u32, End)]) -> Self {
        let mut starts = Vec::new();
        if !ends.is_empty() {
            starts = (0..=discs.len() as u32).map(|n| ends.partition_point(|end| end.0 < n) as u32).collect();
        }
        Self { discs, starts, ends: ends.iter().map(|end| end.1).collect() }
    }

    /// The disc of a point.
    #[must_use]
    pub fn at(&self, point: usize) -> &Disc {
        &self.discs[point]
    }

    /// What ends the disc of a point.
    #[must_use]
    pub fn ends(&self, point: usize) -> &[End] {
        match self.starts.get(point..point + 2) {
            Some(&[from, to]) => &self.ends[from as usize..to as usize],
            _ => &[],
        }
    }

    /// All discs.
    #[must_use]
    pub fn all(&self) -> &[Disc] {
        &self.discs
    }

    /// The share of the straight `way` from a point at `center` to a place in its disc's plane that lies on
    /// the point's own sheet, at most 1.
    #[must_use]
    pub fn share(&self, point: usize, center: DVec3, way: DVec3) -> f64 {
        self.ends(point).iter().filter_map(|end| end.crossed(center, way)).fold(1.0, f64::min)
    }

    /// The discs in the model units of another frame.
    #[must_use]
    pub fn moved(&self, from: &Frame, to: &Frame) -> Self {
        let scale = (from.scale() / to.scale()) as f32;
        let disc = |disc: &Disc| Disc { margin: scale * disc.margin, ..*disc };
        let place = |place: Vec3| to.to_model(from.to_input(place.as_dvec3())).as_vec3();
        let end = |end: &End| End { ends: end.ends.map(place), ..*end };
        Self {
            discs: self.discs.iter().map(disc).collect(),
            starts: self.starts.clone(),
            ends: self.ends.iter().map(end).collect(),
        }
    }
}

#[cfg(test)]
#[allow(clippy::float_cmp)]
mod tests {
    use super::*;

    /// A line along `x = 1` from `y = 0` to `y = 1`, of the sheet where `x` is less.
    fn end() -> End {
        End { ends: [Vec3::X, Vec3::X + Vec3::Y], inward: Vec3::NEG_X }
    }

    #[test]
    fn a_way_leaves_the_sheet_where_it_crosses_the_line_and_nowhere_beside_it() {
        let crossed = |x: f64, y: f64| end().crossed(DVec3::ZERO, DVec3::new(x, y, 0.0));
        assert_eq!(crossed(0.9, 0.5), None, "it stops short of it");
        assert_eq!(crossed(2.0, 0.5), Some(0.5));
        assert_eq!((crossed(2.0, 2.5), crossed(2.0, -0.5)), (None, None), "past its ends");
        assert_eq!(crossed(-3.0, 0.5), None, "away from it");
        let beyond = |x: f64| end().crossed(DVec3::new(1.1, 0.5, 0.0), DVec3::new(x, 0.0, 0.0));
        assert_eq!((beyond(0.1), beyond(-0.2)), (Some(0.0), None), "from a point on the wrong side");
    }

    #[test]
    fn each_disc_has_its_own_ends_and_the_nearest_counts() {
        let nearer = End { ends: [0.5 * Vec3::X, Vec3::new(0.5, 1.0, 0.0)], ..end() };
        let discs = Discs::new(vec![Disc::default(); 3], &[(0, end()), (2, end()), (2, nearer)]);
        assert_eq!([0, 1, 2].map(|n| discs.ends(n).len()), [1, 0, 2]);
        let share = |n: usize| discs.share(n, DVec3::ZERO, DVec3::new(2.0, 0.5, 0.0));
        assert_eq!([0, 1, 2].map(share), [0.5, 1.0, 0.25]);
        let plain = Discs::new(vec![Disc::default(); 3], &[]);
        assert!(plain.ends(2).is_empty() && plain.share(0, DVec3::ZERO, DVec3::X) == 1.0);
    }

    #[test]
    fn a_gap_holds_what_lies_within_half_its_angle() {
        let quarter = Gap { outward: Vec3::X, cosine: std::f32::consts::FRAC_1_SQRT_2 };
        let most = Gap { cosine: -std::f32::consts::FRAC_1_SQRT_2, ..quarter };
        let held = |gap: Gap| {
            [(2.0, 1.9), (2.0, 2.1), (-2.0, -2.1), (-2.0, 1.9)].map(|(x, y)| gap.holds(DVec3::new(x, y, 0.0)))
        };
        assert_eq!(held(quarter), [true, false, false, false]);
        assert_eq!(held(most), [true, true, true, false]);
    }

    #[test]
    fn what_moves_keeps_its_size_in_input_units() {
        let from = Frame { origin: DVec3::new(1.0, 2.0, 3.0), exponent: 1 };
        let to = Frame { origin: DVec3::new(1.5, 2.0, 3.0), exponent: 2 };
        let disc = Disc { margin: 0.25, turn: 0.1, open: true, normal: Vec3::Z, gap: None };
        let moved = Discs::new(vec![disc], &[(0, end())]).moved(&from, &to);
        assert_eq!(*moved.at(0), Disc { margin: 0.125, ..disc });
        assert_eq!((moved.at(0).reach(), disc.sagitta()), (0.25, 0.0125));
        assert_eq!(moved.ends(0)[0].ends[0], Vec3::new(0.375, 0.0, 0.0));
    }
}
