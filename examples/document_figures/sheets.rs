//! A mesh cut along its edges, with points strewn over each of its triangles.

use glam::{DVec2, DVec3};
use qsplat::Result;
use qsplat::analyse::canonical::mix;
use qsplat::analyse::mesh_surface::{Features, Making, Marked};
use qsplat::analyse::surface::{NONE, Rows, Surface};
use qsplat::analyse::worth::Worth;
use qsplat::bake::model_lines;
use qsplat::fit::pose::{Pose, misfit};
use qsplat::sample::region::Region;
use qsplat::tolerance::DEFAULT_EDGE_ANGLE;

use super::models::{Model, mesh};

/// Triangles are cut into no more than so many.
const MOST_PIECES: usize = 4_000_000;

/// Given lines are moved onto edges up to this share of the diagonal off, as in a bake.
const BESIDE: f64 = 0.005;

/// Lines shorter than this share of the diagonal are left out, as at a bound of 0.1 %.
const SHORTEST: f64 = 0.008;

/// The size of features that a generic smooth surface has, as a share of the diagonal: with the bound
/// it says how far splats may be expected to reach, as in a bake.
const FEATURE_SHARE: f64 = 0.25;

/// Places along each side of a border that stand for the line, as dense as the points or denser.
const ALONG: u32 = 16;

/// Places on a surface, by the piece they lie in.
pub struct Strewn {
    /// Model units.
    pub places: Vec<DVec3>,
    /// The piece of each.
    pub piece: Vec<u32>,
    /// The places of each piece.
    of: Rows,
}

/// A surface cut along its edges, and places on it.
pub struct Sheets {
    /// The surface; whatever walks over it stays on its side of every edge.
    pub surface: Surface,
    /// What has to be covered.
    pub points: Strewn,
    /// Where holes are looked for, independent of the points.
    pub probes: Strewn,
}

/// What lies beneath a splat on its own side of every edge.
pub struct Under {
    /// The pieces that it may reach.
    pieces: Vec<u32>,
    /// Places along the borders of these, in the splat's coordinates.
    line: Vec<DVec2>,
}

impl Sheets {
    /// Cuts a model along its edges into pieces no longer than `longest`, but on flat faces, and strews
    /// so many points over it, and as many probes.
    ///
    /// # Errors
    /// [`qsplat::Error::Usage`] where it is a cloud.
    pub fn new(model: &Model, longest: f64, max_error: f64, points: usize) -> Result<Self> {
        let mesh = mesh(model)?;
        let diagonal = qsplat::deliver::model(&model.input).diagonal();
        let given = |lines| {
            let lines = model_lines(lines, &mesh.vertices.frame);
            let segments = lines.iter().flat_map(|line| line.windows(2)).map(|ends| [ends[0], ends[1]]);
            Features::Given { segments: segments.collect(), beside: BESIDE * diagonal }
        };
        let sharp = Features::Sharp { degrees: DEFAULT_EDGE_ANGLE, shortest: SHORTEST * diagonal };
        let features = model.lines.as_ref().map_or(sharp, given);
        let feature = FEATURE_SHARE * diagonal;
        let worth = Worth { reach: libm::cbrt(max_error * feature * feature), max_error, misfit: &misfit };
        let making = Making { longest, most: MOST_PIECES, worth };
        let surface = Marked::of(mesh, &features, &making).0.surface();
        let [points, probes] = [0, 1].map(|seed| Strewn::over(&surface, points, seed));
        Ok(Self { surface, points, probes })
    }

    /// What an ellipse reaches from a piece inside it.
    pub fn under(&self, pose: &Pose, radii: DVec2, piece: u32, region: &mut Region) -> Under {
        let seeds = self.surface.pieces[piece as usize];
        if !region.gather(&self.surface, pose, radii, &seeds) {
            return Under { pieces: vec![piece], line: Vec::new() };
        }
        let pieces = self.surface.pieces_at(region.reached());
        let ends = region.reached().flat_map(|at| {
            [at, self.surface.border_prev[at as usize]].into_iter().filter(|&from| from != NONE)
        });
        let mut starts: Vec<u32> = ends.filter(|&at| self.surface.border_next[at as usize] != NONE).collect();
        starts.sort_unstable();
        starts.dedup();
        let line = starts.into_iter().flat_map(|from| {
            let to = self.surface.border_next[from as usize];
            let [a, b] = [from, to].map(|end| pose.to_local(self.surface.point(end)).truncate());
            (0..=ALONG).map(move |n| a.lerp(b, f64::from(n) / f64::from(ALONG)))
        });
        Under { pieces, line: line.filter(|uv| (uv / radii).length() <= 1.0).collect() }
    }

    /// Length of all edges, either side of each counted, in model units.
    pub fn edge_length(&self) -> f64 {
        let ends = (0..).zip(&self.surface.border_next).filter(|&(_, &to)| to != NONE);
        ends.map(|(from, &to)| self.surface.point(from).distance(self.surface.point(to))).sum()
    }

    /// The unit normal of a piece.
    pub fn normal(&self, piece: u32) -> DVec3 {
        let [a, b, c] = self.surface.pieces[piece as usize].map(|corner| self.surface.point(corner));
        (b - a).cross(c - a).normalize_or(DVec3::Z)
    }
}

impl Under {
    /// The places in the pieces.
    pub fn of<'a>(&'a self, strewn: &'a Strewn) -> impl Iterator<Item = u32> + 'a {
        self.pieces.iter().flat_map(|&piece| strewn.of.row(piece)).copied()
    }

    /// Places along the edges inside the ellipse, in its coordinates.
    pub fn line(&self) -> &[DVec2] {
        &self.line
    }
}

impl Strewn {
    /// Places one by one in equal shares of the area, the same on every run.
    fn over(surface: &Surface, count: usize, seed: u64) -> Self {
        let mut area = 0.0;
        let ends: Vec<f64> = (0..surface.pieces.len() as u32)
            .map(|piece| {
                area += surface.area(piece);
                area
            })
            .collect();
        let random = |n: usize, which: u64| {
            let number = 6 * n as u64 + 3 * seed + which;
            (mix(mix(number)) >> 11) as f64 / (1_u64 << 53) as f64
        };
        let (mut places, mut piece) = (Vec::with_capacity(count), Vec::with_capacity(count));
        for n in 0..count {
            let at = (n as f64 + random(n, 0)) / count as f64 * area;
            let own = ends.partition_point(|&end| end <= at).min(ends.len() - 1);
            let [a, b, c] = surface.pieces[own].map(|corner| surface.point(corner));
            // Osada et al. 2002, section 3: even over a triangle.
            let (root, along) = (random(n, 1).sqrt(), random(n, 2));
            places.push((1.0 - root) * a + root * (1.0 - along) * b + root * along * c);
            piece.push(own as u32);
        }
        let of = Rows::grouped(surface.pieces.len(), &piece);
        Self { places, piece, of }
    }
}
