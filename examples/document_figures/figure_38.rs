//! T Figure 38: which points count as covered near an edge, and what that costs.

use glam::{DVec2, DVec3};
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use qsplat::analyse::canonical::mix;
use qsplat::fit::pose::Pose;
use qsplat::sample::region::Region;
use qsplat::{Result, deliver};

use super::equal_bound;
use super::hull::hull;
use super::models::{Model, edged};
use super::page::Page;
use super::plot::Plot;
use super::search::tree;
use super::sheets::{Sheets, Under};

/// Radii, shares of the diagonal.
const RADII: [f64; 4] = [0.01, 0.02, 0.03, 0.04];

/// Points of each cloud.
const POINTS: usize = 400_000;

/// Pieces are this share of the least radius, and four times as long on flat faces.
const PIECE_SHARE: f64 = 0.125;

/// Only decides which found edges are worth a cut: the bound of the program's defaults, a share of the
/// diagonal.
const BOUND: f64 = 1e-3;

/// Normals that make a smaller cosine (60°) belong to another sheet of the surface.
const FACING: f64 = 0.5;

/// Which of the points beneath a splat count as covered by it.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Rule {
    /// All around its centre but the corners of their hull, on whatever side of an edge (T Fig. 38a).
    Positions,
    /// Those on its own side but the corners of their hull (b).
    Hull,
    /// The same with the edge's line in the hull (c).
    HullAndLine,
    /// Those on its own side that lie a point spacing inside the border, none needed towards an edge.
    Margin,
}

impl Rule {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Positions, Self::Hull, Self::HullAndLine, Self::Margin];

    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Positions => "positions alone",
            Self::Hull => "hull",
            Self::HullAndLine => "hull with the line",
            Self::Margin => "margin",
        }
    }
}

/// For each of some points whether it is no corner of the hull of all and of what else is named.
pub fn inside_hull(points: &[DVec2], line: &[DVec2]) -> Vec<bool> {
    let mut inside = vec![true; points.len()];
    let all: Vec<DVec2> = points.iter().chain(line).copied().collect();
    hull(&all).into_iter().filter(|&corner| corner < points.len()).for_each(|corner| inside[corner] = false);
    inside
}

/// A cloud of a model.
struct Cloud {
    sheets: Sheets,
    tree: ImmutableKdTree<f32, 3>,
    /// Every probe has a point within this.
    spacing: f64,
    diagonal: f64,
}

/// A sampling by discs of one radius.
struct Sampling {
    splats: usize,
    /// Those that an edge reaches into.
    at_edges: usize,
    /// Probes that no splat covers on its own side.
    bare: usize,
}

impl Cloud {
    fn new(model: &Model) -> Result<Self> {
        let diagonal = deliver::model(&model.input).diagonal();
        let longest = PIECE_SHARE * RADII[0] * diagonal;
        let sheets = Sheets::new(model, longest, BOUND * diagonal, POINTS)?;
        let points: Vec<_> = sheets.points.places.iter().map(|place| place.as_vec3()).collect();
        let tree = tree(&points)?;
        let nearest = |probe: &DVec3| {
            let found =
                tree.query(&probe.as_vec3().to_array()).nearest_one::<SquaredEuclidean<f32>>().execute();
            f64::from(found.distance).sqrt()
        };
        let spacing = sheets.probes.places.iter().map(nearest).fold(0.0, f64::max);
        Ok(Self { sheets, tree, spacing, diagonal })
    }

    /// Region growing after Wu and Kobbelt 2004: what nothing covers becomes a centre, in an order that
    /// has nothing to do with where it lies.
    fn sample(&self, radius: f64, rule: Rule) -> Sampling {
        let Sheets { surface, points, probes, .. } = &self.sheets;
        let mut region = Region::new(surface.points.len());
        let mut order: Vec<u32> = (0..points.places.len() as u32).collect();
        order.sort_unstable_by_key(|&n| mix(u64::from(n)));
        let (mut covered, mut seen) = (vec![false; order.len()], vec![false; probes.places.len()]);
        let (mut splats, mut at_edges) = (0, 0);
        for seed in order {
            if covered[seed as usize] {
                continue;
            }
            let piece = points.piece[seed as usize];
            let pose = Pose::at(points.places[seed as usize], self.sheets.normal(piece));
            let under = self.sheets.under(&pose, DVec2::splat(radius), piece, &mut region);
            for point in self.counted(rule, &pose, radius, &under) {
                covered[point as usize] = true;
            }
            covered[seed as usize] = true;
            for probe in under.of(probes) {
                let within = pose.to_local(probes.places[probe as usize]).truncate().length() <= radius;
                seen[probe as usize] |= within && self.faces(&pose, probes.piece[probe as usize]);
            }
            splats += 1;
            at_edges += usize::from(!under.line().is_empty());
        }
        Sampling { splats, at_edges, bare: seen.iter().filter(|seen| !**seen).count() }
    }

    fn faces(&self, pose: &Pose, piece: u32) -> bool {
        self.sheets.normal(piece).dot(pose.axes.z_axis) > FACING
    }

    /// The points that count as covered by a disc.
    fn counted(&self, rule: Rule, pose: &Pose, radius: f64, under: &Under) -> Vec<u32> {
        let points = &self.sheets.points;
        let local = |point: u32| pose.to_local(points.places[point as usize]).truncate();
        let members: Vec<u32> = if rule == Rule::Positions {
            self.around(pose.center, radius)
        } else {
            let near = |&point: &u32| {
                local(point).length() <= radius && self.faces(pose, points.piece[point as usize])
            };
            under.of(points).filter(near).collect()
        };
        let places: Vec<DVec2> = members.iter().map(|&point| local(point)).collect();
        let inside = match rule {
            Rule::Positions | Rule::Hull => inside_hull(&places, &[]),
            Rule::HullAndLine => inside_hull(&places, under.line()),
            Rule::Margin => places.iter().map(|uv| uv.length() <= radius - self.spacing).collect(),
        };
        members.into_iter().zip(inside).filter_map(|(point, inside)| inside.then_some(point)).collect()
    }

    /// The points in a ball.
    fn around(&self, center: DVec3, radius: f64) -> Vec<u32> {
        let center = center.as_vec3().to_array();
        let query = self.tree.query(&center);
        let found = query.within::<SquaredEuclidean<f32>>((radius * radius) as f32).unsorted().execute();
        found.iter().map(|found| found.item).collect()
    }
}

/// What a rule comes to at a radius.
struct Row {
    model: String,
    rule: Rule,
    /// Of the diagonal.
    share: f64,
    splats: usize,
    /// Splats that an edge reaches into, for each radius of edge.
    dense: f64,
    /// Bare probes, millionths.
    bare: f64,
}

impl Row {
    fn new(model: &Model, cloud: &Cloud, rule: Rule, share: f64) -> Self {
        let radius = share * cloud.diagonal;
        let Sampling { splats, at_edges, bare } = cloud.sample(radius, rule);
        let dense = at_edges as f64 * radius / cloud.sheets.edge_length();
        let bare = 1e6 * bare as f64 / POINTS as f64;
        Self { model: model.name.clone(), rule, share, splats, dense, bare }
    }

    fn cells(&self) -> Vec<String> {
        vec![
            self.model.clone(),
            format!("{:.0} %", 100.0 * self.share),
            self.rule.name().to_owned(),
            self.splats.to_string(),
            format!("{:.2}", self.dense),
            format!("{:.0}", self.bare),
        ]
    }
}

/// The section.
///
/// # Errors
/// Those of reading the models and writing the page.
pub fn make(page: &mut Page) -> Result<()> {
    let models = edged()?;
    let mut rows = Vec::new();
    for model in &models {
        let cloud = Cloud::new(model)?;
        let runs = Rule::ALL.into_iter().flat_map(|rule| RADII.map(|share| (rule, share)));
        rows.extend(runs.map(|(rule, share)| Row::new(model, &cloud, rule, share)));
    }
    page.section("T Figure 38: which points count as covered near an edge");
    page.say(&format!(
        "The document (sections 3.1 and 5, Figures 22 and 38, by eye): if the points on the convex hull of \
         what a splat covers do not count as covered, so that neighbours must cover them and no hole is \
         left, far too many splats come to lie along an edge, beyond which nothing covers its points; if the \
         points across count too, holes come to lie there; with the edge's line in the hull neither happens. \
         Ours: {POINTS} points strewn over each model, discs of one radius, and the same region growing with \
         four rules. *Positions alone*: points around a centre count whatever side of an edge they lie on. \
         *Hull*: those on its own side. *Hull with the line*: the same with the line in the hull. *Margin*, \
         the rule that bakes follow: a point counts that lies a point spacing (the farthest that any place \
         has to its nearest point, on whatever side) inside the border, none being needed towards an edge; a \
         place may stay bare on a piece too narrow for points of its own. *At edges* are \
         splats that an edge reaches into, for each radius of its length and side. *Bare* is the share of as \
         many other places of the surface that no splat covers from their own side, in millionths. {}",
        verdict(&rows)
    ));
    let columns = ["model", "radius / D", "rule", "splats", "at edges, a radius of edge", "bare, millionths"];
    page.table("figure-38", &columns, &rows.iter().map(Row::cells).collect::<Vec<_>>())?;
    for model in &models {
        let of = |rule: Rule| rows.iter().filter(move |row| row.model == model.name && row.rule == rule);
        let curve = |rule: Rule| of(rule).map(|row| (100.0 * row.share, row.dense)).collect();
        let curves = Rule::ALL.map(|rule| (rule.name(), curve(rule))).to_vec();
        let title = format!("{}: splats at edges, a radius of edge, against the radius", model.name);
        let plot =
            Plot { title: &title, across: "radius, % of D", up: "splats at edges, a radius of edge", curves };
        page.picture(&format!("figure-38-{}", model.name), &title, &plot.svg()?)?;
    }
    equal_bound::make(page, &models)
}

/// What the document says, in our numbers.
fn verdict(rows: &[Row]) -> String {
    let of = |rule: Rule| rows.iter().filter(move |row| row.rule == rule);
    let most_bare = |rule: Rule| of(rule).map(|row| row.bare).fold(0.0, f64::max);
    let ratios = |over: Rule, under: Rule, value: &dyn Fn(&Row) -> f64| {
        let ratios = of(over).zip(of(under)).map(|(a, b)| value(a) / value(b));
        let [low, high] =
            ratios.fold([f64::INFINITY, 0.0], |[low, high], ratio| [ratio.min(low), ratio.max(high)]);
        format!("{low:.2} to {high:.2}")
    };
    format!(
        "Here the hull takes {} times the splats at edges that the hull with the line does, and {} times \
         the splats in all; the margin {} times those in all. Up to {:.0} millionths stay bare with \
         positions alone, {:.0} with the hull, {:.0} with the line in it, {:.0} with the margin.",
        ratios(Rule::Hull, Rule::HullAndLine, &|row| row.dense),
        ratios(Rule::Hull, Rule::HullAndLine, &|row| row.splats as f64),
        ratios(Rule::Margin, Rule::HullAndLine, &|row| row.splats as f64),
        most_bare(Rule::Positions),
        most_bare(Rule::Hull),
        most_bare(Rule::HullAndLine),
        most_bare(Rule::Margin),
    )
}
