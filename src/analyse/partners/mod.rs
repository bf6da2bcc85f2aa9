//! Clip partners: which splats cut which, and how their areas come together.
//!
//! Ivo, Vidal and Cavalcante-Neto, "A new method for cutting splats of models with sharp
//! features", sections III and IV; Ivo 2020, 2.1 and Fig. 11. Four steps, each a file:
//!
//! 1. [`neighbours`]: splats nearer than their radii reach (equation 1, whose sign is a
//!    misprint).
//! 2. `meeting`: where two of them cross at an angle (equations 2 to 13).
//! 3. `sides`: whether a splat keeps what its partner sees or what it does not (equation
//!    16).
//! 4. `groups`: whether the areas of partners unite or intersect (Fig. 5), mixed sets
//!    taken apart.
//!
//! The paper's splats are many small discs of about one size, whose centres stand for all of
//! them. Ours are few, large, bent and of all sizes: a face of a part may be one splat, and the
//! ellipse around it may have its centre where the face has a hole. So what the paper asks of
//! the planes through the centres is asked of the quadrics where they meet, and what it asks of
//! a splat's centre is asked of the places that the splat shows.

mod groups;
mod meeting;
mod sides;
#[cfg(test)]
mod tests;

use glam::DVec3;
use rayon::prelude::*;

use crate::model::neighbours::neighbours;
use crate::model::partner::{Cut, Group, Partner};
use crate::model::splat::Splat;

/// What a splat is there for.
#[derive(Clone, Debug, Default)]
pub struct Shown {
    /// Places of the surface that it covers, near its quadric: at least one. Nothing may cut
    /// them away.
    pub places: Vec<DVec3>,
    /// Segments within its ellipse along which the surface ends or bends sharply; `None` if that
    /// is not known. Two splats meet beside such segments of both; where they cross
    /// elsewhere, one of them stands out into the air.
    pub ends: Option<Vec<[DVec3; 2]>>,
}

/// When two splats are partners.
#[derive(Clone, Copy, Debug)]
pub struct Rule {
    /// `w_s`: surfaces are different where the scalar product of their normals is below this.
    pub agree: f64,
    /// Error bound, model units.
    pub max_error: f64,
}

/// What was found, for the report.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Pairs of partners.
    pub pairs: usize,
    /// Splats with partners whose areas all unite.
    pub united: usize,
    /// Splats with partners whose areas all intersect.
    pub intersected: usize,
    /// Splats whose partners fall into groups.
    pub mixed: usize,
    /// Cuts given up because they would have taken away what the splat shows.
    pub given_up: usize,
}

/// A partner as one of the two sees it.
#[derive(Clone, Debug)]
struct Candidate {
    partner: Partner,
    /// Where the two meet.
    edge: Vec<DVec3>,
    /// How far apart neighbouring places of the edge may lie.
    spacing: f64,
}

/// The groups of partners of each splat, and what they came to.
///
/// `shown` is what each splat is there for. The result does not depend on the number of threads.
#[must_use]
pub fn clip_partners(splats: &[Splat], shown: &[Shown], rule: &Rule) -> (Vec<Vec<Group>>, Tally) {
    let candidates = candidates(splats, shown, rule);
    let found: Vec<(Vec<Group>, usize)> = candidates
        .par_iter()
        .enumerate()
        .map(|(n, candidates)| groups::grouped(candidates, &feet(&splats[n], &shown[n]), rule.max_error))
        .collect();
    let given_up = found.iter().map(|(_, given_up)| given_up).sum();
    let groups: Vec<Vec<Group>> = found.into_iter().map(|(groups, _)| groups).collect();
    let tally = Tally { given_up, ..tally(&groups) };
    (groups, tally)
}

/// For each splat, the splats that meet it, ascending, with the side it keeps of each.
fn candidates(splats: &[Splat], shown: &[Shown], rule: &Rule) -> Vec<Vec<Candidate>> {
    let pairs = neighbours(splats);
    let met: Vec<_> = pairs
        .par_iter()
        .filter_map(|&[a, b]| {
            let meeting = meeting::meeting([&splats[a as usize], &splats[b as usize]], rule.agree)?;
            let meeting = [a, b].into_iter().try_fold(meeting, |meeting, of| {
                meeting.beside(shown[of as usize].ends.as_deref(), rule.max_error)
            })?;
            Some(([a, b], meeting))
        })
        .collect();
    let mut candidates = vec![Vec::new(); splats.len()];
    for ([a, b], meeting) in met {
        for (of, by) in [(a, b), (b, a)] {
            let partner = |cut: Cut| Partner::new(by, &splats[by as usize], cut, rule.max_error);
            let places = &shown[of as usize].places;
            if let Some(cut) = sides::cut(&partner(Cut::Seen), places, &meeting.places, rule.max_error) {
                candidates[of as usize].push(Candidate {
                    partner: partner(cut),
                    edge: meeting.places.clone(),
                    spacing: meeting.spacing,
                });
            }
        }
    }
    candidates.iter_mut().for_each(|list: &mut Vec<Candidate>| list.sort_by_key(|one| one.partner.splat));
    candidates
}

/// The places of the quadric over or under those that the splat shows.
fn feet(splat: &Splat, shown: &Shown) -> Vec<DVec3> {
    let foot = |place: &DVec3| splat.surface_point(splat.to_local(*place).truncate());
    shown.places.iter().map(foot).collect()
}

fn tally(groups: &[Vec<Group>]) -> Tally {
    let mut tally = Tally::default();
    let mut pairs = Vec::new();
    for (n, groups) in groups.iter().enumerate() {
        pairs.extend(groups.iter().flatten().map(|partner| {
            let (a, b) = (n as u32, partner.splat);
            (a.min(b), a.max(b))
        }));
        match groups.as_slice() {
            [] => {}
            [group] if group.len() > 1 => tally.intersected += 1,
            groups if groups.iter().all(|group| group.len() == 1) => tally.united += 1,
            _ => tally.mixed += 1,
        }
    }
    pairs.sort_unstable();
    pairs.dedup();
    tally.pairs = pairs.len();
    tally
}
