//! The rules of T Figure 38 at one error bound: splats of every size, from the same candidates.

use std::collections::BinaryHeap;

use glam::{DVec2, DVec3};
use qsplat::analyse::canonical::mix;
use qsplat::bake::{Clips, DEFAULT_EFFORT, MaxError, Options, Silent};
use qsplat::fit::pose::Pose;
use qsplat::format::quantize::Quantizer;
use qsplat::format::{Limits, decode, encode};
use qsplat::measure::holes::{self, Depths, Mark};
use qsplat::measure::views::{SIDE, views};
use qsplat::model::asset::{Accuracy, Asset};
use qsplat::model::splat::Splat;
use qsplat::render::cpu;
use qsplat::render::input::{Prepared, Style};
use qsplat::sample::budget::Budget;
use qsplat::sample::candidates::{Regions, candidates};
use qsplat::sample::cover::cost;
use qsplat::sample::grow::Grower;
use qsplat::sample::polygon;
use qsplat::sample::scout::Begun;
use qsplat::sample::settle::Candidate;
use qsplat::{Result, deliver};
use rayon::prelude::*;

use super::figure_38::{Rule, inside_hull};
use super::models::Model;
use super::page::Page;
use super::sheets::Sheets;

/// Error bounds, shares of the diagonal.
const BOUNDS: [f64; 2] = [1e-3, 5e-4];

/// Points to cover, and as many probes.
const POINTS: usize = 200_000;

/// Pieces are no longer than this share of the diagonal, about as in a bake at 0.1 %.
const LONGEST: f64 = 0.0066;

/// A splat shows within this many bounds of the surface: at the rim twice the bound is allowed.
const RIM: f64 = 2.0;

/// A candidate and the points that count as covered by it.
struct Offer {
    candidate: Candidate,
    counted: Vec<u32>,
}

/// Everything but the rule.
struct Bench<'a> {
    model: &'a Model,
    /// Of the diagonal.
    bound: f64,
    sheets: &'a Sheets,
    grower: &'a Grower<'a>,
    regions: &'a Regions,
    max_error: f64,
}

impl Bench<'_> {
    /// The points beneath a candidate that lie within the bound of it, and which of them count.
    fn beneath(&self, candidate: &Candidate, rule: Rule) -> (Vec<u32>, Vec<bool>) {
        let splat = &candidate.splat;
        let pose = Pose { center: splat.center, axes: splat.axes };
        let points = &self.sheets.points;
        let Some(&seed) = candidate.pieces.first() else { return (Vec::new(), Vec::new()) };
        let under = self.regions.with(|region| self.sheets.under(&pose, splat.radii, seed, region));
        let near = |&point: &u32| shows(splat, points.places[point as usize], self.max_error);
        let members: Vec<u32> = under.of(points).filter(near).collect();
        let places: Vec<DVec2> =
            members.iter().map(|&point| splat.to_local(points.places[point as usize]).truncate()).collect();
        let whole = |&point: &u32| candidate.pieces.binary_search(&points.piece[point as usize]).is_ok();
        let inside = match rule {
            Rule::Positions | Rule::Hull => inside_hull(&places, &[]),
            Rule::HullAndLine => inside_hull(&places, under.line()),
            Rule::Margin => members.iter().map(whole).collect(),
        };
        (members, inside)
    }

    fn offer(&self, candidate: Candidate, rule: Rule) -> Offer {
        let (members, inside) = self.beneath(&candidate, rule);
        let counted = members.into_iter().zip(inside).filter_map(|(point, inside)| inside.then_some(point));
        Offer { counted: counted.collect(), candidate }
    }

    /// The splat of a point that no other covers.
    fn alone(&self, point: u32) -> Option<Candidate> {
        let piece = self.sheets.points.piece[point as usize];
        self.regions.with(|region| {
            let grown = self.grower.grow(piece, region);
            let grown = grown.or_else(|| self.grower.grow_overhanging(piece, region));
            grown.or_else(|| polygon::over(self.grower, piece, region))
        })
    }

    /// Splats that cover all points by a rule, and how many of them are the last resort of one point.
    fn covered(&self, grown: &[Candidate], rule: Rule) -> (Vec<Splat>, usize) {
        let mut offers: Vec<Offer> =
            grown.par_iter().map(|candidate| self.offer(candidate.clone(), rule)).collect();
        let mut times = vec![0_u32; self.sheets.points.places.len()];
        let mut chosen = greedy(&offers, &mut times);
        let mut order: Vec<u32> = (0..times.len() as u32).collect();
        order.sort_unstable_by_key(|&point| mix(u64::from(point)));
        let mut added = 0;
        for point in order {
            if times[point as usize] == 0
                && let Some(candidate) = self.alone(point)
            {
                let mut offer = self.offer(candidate, rule);
                // Even on the hull, as where it lies alone, the seed itself needs no further splat.
                if !offer.counted.contains(&point) {
                    offer.counted.push(point);
                }
                offer.counted.iter().for_each(|&point| times[point as usize] += 1);
                chosen.push(offers.len());
                offers.push(offer);
                added += 1;
            }
        }
        drop_redundant(&offers, &mut chosen, &mut times);
        (chosen.into_iter().map(|index| offers[index].candidate.splat.clone()).collect(), added)
    }

    /// Probes that no splat shows at.
    fn bare(&self, asset: &Asset) -> usize {
        let probes = &self.sheets.probes;
        let reach = |splat: &Splat| splat.bounding_radius();
        let bare = probes.places.par_iter().filter(|&&place| {
            !asset.splats.iter().any(|splat| {
                splat.center.distance(place) <= reach(splat) && shows(splat, place, RIM * self.max_error)
            })
        });
        bare.count()
    }
}

/// Whether a splat is there, within a distance along its normal.
fn shows(splat: &Splat, place: DVec3, within: f64) -> bool {
    let local = splat.to_local(place);
    let uv = local.truncate();
    (local.z - splat.height(uv)).abs() <= within && splat.covers(uv)
}

/// Always the candidate that covers most of what is still uncovered, for its bytes.
fn greedy(offers: &[Offer], times: &mut [u32]) -> Vec<usize> {
    // Non-negative floats compare as their bits do.
    let gain = |index: usize, times: &[u32]| {
        let new = offers[index].counted.iter().filter(|&&point| times[point as usize] == 0).count();
        (new as f64 / cost(&offers[index].candidate.splat)).to_bits()
    };
    let mut heap: BinaryHeap<(u64, usize)> =
        (0..offers.len()).map(|index| (gain(index, times), index)).collect();
    let mut chosen = Vec::new();
    while let Some((_, index)) = heap.pop() {
        let now = (gain(index, times), index);
        if now.0 == 0 {
            continue;
        }
        // Gains only fall, so one that still leads the others' old gains is the greatest.
        if heap.peek().is_some_and(|next| *next > now) {
            heap.push(now);
            continue;
        }
        offers[index].counted.iter().for_each(|&point| times[point as usize] += 1);
        chosen.push(index);
    }
    chosen
}

/// Drops splats all of whose points others cover, those that cover the fewest first.
fn drop_redundant(offers: &[Offer], chosen: &mut Vec<usize>, times: &mut [u32]) {
    let mut order = chosen.clone();
    order.sort_by_key(|&index| (offers[index].counted.len(), index));
    for index in order {
        if offers[index].counted.iter().all(|&point| times[point as usize] > 1) {
            offers[index].counted.iter().for_each(|&point| times[point as usize] -= 1);
            chosen.retain(|&other| other != index);
        }
    }
}

/// Pixels of the 26 views that are missing or seen through.
fn missing(model: &Model, asset: &Asset) -> Result<u64> {
    let input = deliver::model(&model.input);
    let prepared = Prepared::new(input, &Style::default());
    let mut missing = 0;
    for view in views(input) {
        let splats = cpu::visibility(asset, &view.camera, [SIDE; 2])?;
        let own = Depths::new([SIDE; 2], prepared.met(&view.camera, [SIDE; 2])?);
        let map = holes::compare(&own, &splats, holes::behind(asset));
        missing += map.count(Mark::Missing) + map.count(Mark::Through);
    }
    Ok(missing)
}

impl Bench<'_> {
    fn asset(&self, splats: Vec<Splat>) -> Asset {
        Asset {
            frame: self.model.input.cloud().frame,
            diagonal: self.max_error / self.bound,
            max_error: self.max_error,
            fit: Accuracy::default(),
            has_colors: false,
            splats,
        }
    }

    /// The row of a rule, from candidates that are the same for all.
    fn ruled(&self, grown: &[Candidate], rule: Rule) -> Result<Vec<String>> {
        let (splats, added) = self.covered(grown, rule);
        let bytes = encode(&self.asset(splats))?;
        self.row(rule.name(), &decode(&bytes, &Limits::default())?, bytes.len(), added.to_string())
    }

    /// The row of the program's own bake.
    fn baked(&self) -> Result<Vec<String>> {
        let options = Options { max_error: MaxError::Relative(self.bound), ..self.model.options() };
        let whole = deliver::deliver(&self.model.input, &options, &mut Silent)?;
        self.row("a whole bake", &whole.asset, whole.bytes.len(), "–".to_owned())
    }

    fn row(&self, name: &str, asset: &Asset, bytes: usize, added: String) -> Result<Vec<String>> {
        Ok(vec![
            self.model.name.clone(),
            format!("{:.2} %", 100.0 * self.bound),
            name.to_owned(),
            asset.splats.len().to_string(),
            added,
            bytes.to_string(),
            format!("{:.0}", 1e6 * self.bare(asset) as f64 / POINTS as f64),
            missing(self.model, asset)?.to_string(),
        ])
    }
}

/// The rows of a model at a bound.
fn rows(model: &Model, bound: f64) -> Result<Vec<Vec<String>>> {
    let diagonal = deliver::model(&model.input).diagonal();
    let max_error = bound * diagonal;
    let sheets = Sheets::new(model, LONGEST * diagonal, max_error, POINTS)?;
    let quantizer = Quantizer::new(max_error);
    let round = |splat: &Splat, fineness: u8| quantizer.snap_within(splat, fineness).ok();
    let grower = Grower::new(&sheets.surface, Budget::new(max_error, Clips::Curved), &round);
    let regions = Regions::new(sheets.surface.points.len());
    let bench = Bench { model, bound, sheets: &sheets, grower: &grower, regions: &regions, max_error };
    let grown = candidates(&grower, &regions, &Begun::default(), DEFAULT_EFFORT, |_| ());
    let ruled = [Rule::Hull, Rule::HullAndLine, Rule::Margin].map(|rule| bench.ruled(&grown, rule));
    ruled.into_iter().chain([bench.baked()]).collect()
}

/// The part of the section that compares at one bound.
///
/// # Errors
/// Those of baking and writing.
pub fn make(page: &mut Page, models: &[Model]) -> Result<()> {
    page.say(&format!(
        "At one error bound, with splats of every size and curves along the edges, from the same candidates: \
         {POINTS} points, each to be covered within the bound by the rule; always the candidate that covers \
         most for its bytes; then a splat grown at each point that is left (*for one point*); then those \
         are dropped whose points others cover. By the margin rule those points count whose whole triangle \
         lies in the splat. *Bare* counts other places, in millionths, *missing* the pixels of 26 views that \
         show no splat, or the far side through a hole, of about 6.7 million. A whole bake, which \
         follows the margin rule too, goes on to merge splats, chooses anew, and mends what pictures show."
    ));
    let mut all = Vec::new();
    for model in models {
        for bound in BOUNDS {
            all.extend(rows(model, bound)?);
        }
    }
    let columns = [
        "model",
        "bound / D",
        "rule",
        "splats",
        "for one point",
        "bytes",
        "bare, millionths",
        "missing pixels",
    ];
    page.table("figure-38-bound", &columns, &all)
}
