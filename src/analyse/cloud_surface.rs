//! From a point cloud to its surface: tell its points apart along feature lines, join them, leave out
//! outliers.

use std::ops::Range;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::cloud_assembly::Assembly;
use super::cloud_graph::{Joined, Parted, Sites, Whole};
use super::cloud_normals::{NormalSource, Normals};
use super::distinct::Distinct;
use super::given_lines::Matched;
use super::line_cut::LineCut;
pub use super::open_places::OpenPlace;
use super::open_places::open_places;
use super::outliers::{Strewn, outliers};
pub use super::sided::Lines;
use super::sided::{Cleaned, Sided};
pub use super::sparse::Sparse;
use super::surface::{NONE, Surface};
use super::thin::{Reach, Sheet, owners};
use crate::error::Result;
use crate::model::cloud::Cloud;
use crate::model::discs::{Disc, Discs, End};
use crate::model::polyline::length;

/// The surface of a cloud, and what is not part of it.
#[derive(Clone, Debug, Default)]
pub struct CloudSurface {
    /// The surface.
    pub surface: Surface,
    /// Points of the cloud that belong to no surface, ascending: outliers.
    pub left_out: Vec<u32>,
    /// What the others tell of it by themselves, in the cloud's order, if they lie as far apart as was asked for.
    pub discs: Option<Discs>,
    /// Segments of the lines, given or found and resampled, at which a sheet of the surface ends.
    pub edges: usize,
    /// Its borders and the rims of its holes, lines aside: there splats that cover its points may leave a hole.
    pub open_places: Vec<OpenPlace>,
    /// Where its points lie too far apart for the bound, if any do.
    pub sparse: Option<Sparse>,
    /// What became of the lines, if any were given; `edges` counts their samples' segments.
    pub matched: Option<Matched>,
}

/// What a cloud's surface is, as far as each of its points tells.
#[derive(Clone, Debug, Default)]
pub struct CloudDiscs {
    /// Points of the cloud that belong to no surface, ascending: outliers.
    pub left_out: Vec<u32>,
    /// The discs of the others, in the cloud's order.
    pub discs: Discs,
}

/// A cloud's points, joined to their sheets and told from outliers.
struct Laid {
    points: Distinct,
    normals: Normals,
    cut: Option<LineCut>,
    joined: Vec<Joined>,
    /// Pairs of a point on a line and one of the cloud.
    joins: Vec<(u32, u32)>,
    /// What ends the discs of points beside lines.
    ends: Vec<(u32, End)>,
    on_line: Vec<bool>,
    outlier: Vec<bool>,
    /// Corners of what points beside lines stand for: see [`Sites::cells`].
    cells: Vec<(u32, Vec<Vec3>)>,
    /// What became of the lines that part nothing.
    cleaned: Cleaned,
}

/// The surface of a cloud, cut along feature lines.
///
/// `noise` is the standard deviation of the points from their surface, model units; `None` where they show
/// none. Of points that lie densely, some stand for those within `reach` of them: see [`super::thin`].
///
/// Its discs are told where the median of its points' margins, model units, is one of `told`; where its points lie too
/// far apart for a bound, model units, is told of `bound`, if that is given.
///
/// Neither the order of points and lines nor repeated points change anything but `left_out` and `discs`.
/// Lines far from the cloud, and lines around which the points show no sheets, cut nothing.
///
/// # Errors
/// [`crate::Error::Usage`] where normals are to be kept and none is sound.
pub fn cloud_surface(
    cloud: &Cloud,
    source: NormalSource,
    lines: Lines<'_>,
    noise: Option<f64>,
    reach: Option<Reach>,
    told: Option<Range<f64>>,
    bound: Option<f64>,
) -> Result<CloudSurface> {
    let laid = Laid::of(cloud, source, lines, noise)?;
    let (left_out, open_places) = (laid.left_out(), laid.open_places());
    let sparse = bound.and_then(|bound| laid.sparse(bound));
    let discs = told.filter(|told| told.contains(&laid.median_margin())).map(|_| laid.discs());
    let Laid { points, normals, cut, joined, joins, on_line, outlier, cells, cleaned, .. } = laid;
    let sheet = Sheet {
        positions: &points.positions,
        normals: &normals.normals,
        joined: &joined,
        outlier: &outlier,
        on_line: &on_line,
        cells: &cells,
    };
    let owner = owners(&sheet, reach);
    let surface = Assembly::new(&sheet, &points.colors, &owner, cut.as_ref()).surface(joins);
    let (edges, length) = cut.as_ref().map_or((0, 0.0), LineCut::found);
    let matched = match lines {
        Lines::Given(lines) if !lines.is_empty() => Some(matched(lines, edges, length, cleaned)),
        Lines::Given(_) | Lines::Found(_) => None,
    };
    Ok(CloudSurface { surface, left_out, discs, edges, open_places, sparse, matched })
}

/// The surface of a cloud as its points tell it by themselves: what splats that cover it have to fill, and
/// may. The points left out are those that [`cloud_surface`] leaves out, and margins and lines are the same.
///
/// # Errors
/// As [`cloud_surface`].
pub fn cloud_discs(
    cloud: &Cloud,
    source: NormalSource,
    lines: Lines<'_>,
    noise: Option<f64>,
) -> Result<CloudDiscs> {
    let laid = Laid::of(cloud, source, lines, noise)?;
    Ok(CloudDiscs { left_out: laid.left_out(), discs: laid.discs() })
}

impl Laid {
    fn of(cloud: &Cloud, source: NormalSource, lines: Lines<'_>, noise: Option<f64>) -> Result<Self> {
        let sided = Sided::of(cloud, source, lines, noise)?;
        let (sites, cut) = (sided.sites(), sided.cut.as_ref());
        let lined = cut.map(|cut| Lined { sites: &sites, cut });
        let joined = lined.as_ref().map_or_else(|| sites.join(&Whole), |lined| sites.join(lined));
        let cells = lined.as_ref().map(|lined| sites.cells(lined)).unwrap_or_default();
        let joins = cut.map(|cut| cut.joins(&sites)).unwrap_or_default();
        let ends = cut.map(|cut| cut.ends(&sites, &joined)).unwrap_or_default();
        let mut on_line = vec![false; joined.len()];
        for &(_, point) in &joins {
            on_line[point as usize] = true;
        }
        let strewn = Strewn {
            positions: &sided.points.positions,
            nearest: &sided.nearest,
            spacing: &sided.spacing,
            joined: &joined,
            on_line: &on_line,
        };
        let outlier = outliers(&strewn);
        // Their neighbours are no longer needed.
        let Sided { points, normals, cut, cleaned, .. } = sided;
        Ok(Self { points, normals, cut, joined, joins, ends, on_line, outlier, cells, cleaned })
    }

    /// Half of the points have no wider margins, model units; 0 for no points.
    fn median_margin(&self) -> f64 {
        let mut margins: Vec<f32> = self.joined.iter().map(|joined| joined.margin).collect();
        let middle = margins.len() / 2;
        if margins.is_empty() {
            0.0
        } else {
            f64::from(*margins.select_nth_unstable_by(middle, f32::total_cmp).1)
        }
    }

    fn left_out(&self) -> Vec<u32> {
        let place = &self.points.place;
        let is_outlier = |v: &u32| self.outlier[place[*v as usize] as usize];
        (0..place.len() as u32).filter(is_outlier).collect()
    }

    /// Where the cloud is open, but for what a line ends.
    fn open_places(&self) -> Vec<OpenPlace> {
        let mut counts: Vec<bool> = self.outlier.iter().map(|outlier| !outlier).collect();
        self.ends.iter().for_each(|&(point, _)| counts[point as usize] = false);
        open_places(&self.points.positions, &self.joined, |n| counts[n])
    }

    /// Where points, but for outliers, lie too far apart for a bound.
    fn sparse(&self, bound: f64) -> Option<Sparse> {
        let nothing = Disc::default();
        let disc = |n: u32| if self.outlier[n as usize] { nothing } else { self.disc(n) };
        let all = (0..self.joined.len() as u32).into_par_iter();
        Sparse::of(all.map(|n| (self.points.positions[n as usize], disc(n))), bound)
    }

    /// The discs of the cloud's points but for outliers, in its order.
    fn discs(&self) -> Discs {
        let kept: Vec<u32> =
            self.points.place.iter().copied().filter(|&n| !self.outlier[n as usize]).collect();
        let ends = (0_u32..).zip(&kept).flat_map(|(at, &n)| {
            let from = self.ends.partition_point(|end| end.0 < n);
            self.ends[from..].iter().take_while(move |end| end.0 == n).map(move |end| (at, end.1))
        });
        let ends: Vec<(u32, End)> = ends.collect();
        Discs::new(kept.par_iter().map(|&n| self.disc(n)).collect(), &ends)
    }

    /// By how much the normal turns from a point toward another, as far as the point's margin at least.
    fn turn(&self, point: u32, other: u32) -> f32 {
        let [a, b] = [point as usize, other as usize];
        let way = self.points.positions[a].distance(self.points.positions[b]);
        let farther = (self.joined[a].margin / way).clamp(1.0, FARTHER);
        farther * self.normals.normals[a].distance(self.normals.normals[b])
    }

    fn disc(&self, point: u32) -> Disc {
        let (normal, joined) = (self.normals.normals[point as usize], &self.joined[point as usize]);
        let others = joined.sectors.iter().filter(|&&other| other != NONE);
        let turn = others.map(|&other| self.turn(point, other)).fold(0.0, f32::max);
        Disc { normal, margin: joined.margin, turn, open: joined.open, gap: joined.gap }
    }
}

/// Turns of normals are told for up to this many times the way on which they are seen: beyond, they are
/// noise rather than the surface.
const FARTHER: f32 = 2.0;

/// Lines as they part the points of a cloud.
struct Lined<'a> {
    sites: &'a Sites<'a>,
    cut: &'a LineCut,
}

impl Parted for Lined<'_> {
    fn is_beside(&self, point: u32) -> bool {
        self.cut.is_beside(point)
    }

    fn parts(&self, a: u32, b: u32) -> bool {
        self.cut.parts(self.sites, a, b)
    }

    fn ends(&self, point: u32, reach: f64) -> Vec<End> {
        self.cut.ends_within(self.sites, point, reach)
    }
}

fn matched(lines: &[Vec<DVec3>], edges: usize, cut_length: f64, cleaned: Cleaned) -> Matched {
    let length = length(lines);
    let Cleaned { far: lost, moved, merged: merged_length, smooth: smooth_length } = cleaned;
    let matched_length = (cut_length + merged_length + smooth_length).min(length);
    let moved_length = moved.min(length);
    Matched { edges, length, matched_length, smooth_length, moved_length, merged_length, lost }
}
