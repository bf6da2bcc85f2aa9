//! Which creases are worth a cut.
//!
//! An angle between two facets is a feature edge only if it goes on to either side: the bumps of
//! a scan and the facets of a tube are as sharp. A splat that stops at a feature edge reaches
//! farther than one that goes over it, and where it does not, a cut serves nothing.

use glam::DVec3;
use rayon::prelude::*;

use super::chains::{Chain, chains};
use super::edge_paths::EdgePaths;
use super::edges::{Edge, Edges, Half};
use super::marks::Marks;
use super::patches::{Disc, Patches};
use super::weld::Welded;

/// How far the farthest of some points lies from a splat fitted to them, given about its normal.
pub type Misfit<'a> = dyn Fn(&[DVec3], DVec3) -> f64 + Sync + 'a;

/// What decides whether a crease is worth a cut.
#[derive(Clone, Copy)]
pub struct Worth<'a> {
    /// Radius that a splat may be expected to reach on a smooth surface, model units.
    pub reach: f64,
    /// The error bound, model units.
    pub max_error: f64,
    /// How well a splat fits.
    pub misfit: &'a Misfit<'a>,
}

/// Depths of the patches looked at on either side, as shares of the reach, the deepest first.
const DEPTHS: [f64; 5] = [1.0, 0.5, 0.25, 0.125, 0.0625];

/// The first of those at which a splat fits decides, and the next: where the surface beside a crease bends nearly
/// as much as one splat can, as the wall of a hole does, it misses there by as much as one over the crease; at half
/// the depth it hardly misses, and the other still does by half.
const DECISIVE: usize = 2;

/// A patch over the crease, as wide as those beside it are deep, has this share of their depth for
/// its radius: on a smooth surface all three fit about as well. It goes over all other creases too:
/// the teeth of a rack, each alone between its neighbours, would pass for smooth.
const OVER: f64 = 0.5;

/// A crease matters where a splat over it misses by more than this share of the bound.
const LEAST_MISS: f64 = 0.25;

/// A crease matters where a splat over it misses by this many times what those beside it do.
const SHARPER: f64 = 2.0;

/// A crease whose faces turn from each other by more than this (cosine of 60°) is a fold. It matters where no splat
/// fits beside it, and wherever one over the two faces misses them: how far splats reach beside it says little where
/// a wall is narrow, as that of a screw's hole is. The right angles of machined parts are well within; at 90° parts
/// of robots take up to a fifth more bytes, and at 40° scans up to 4 % more.
const FOLD: f64 = 0.5;

/// Faces that turn from each other by more than this (cosine of 100°) meet in a sharp fold: one that splats miss is a
/// line wherever it lies, since splats beside other lines are cut along it. With these the body of a robot takes 9 %
/// fewer bytes, two scans 1 and 3 % fewer and one 1.5 % more.
const SHARP_FOLD: f64 = -0.17;

/// Faces that turn from each other by more than this (cosine of 120°) meet in a knife edge. A steep parabola, seen along
/// their mean normal, misses the two by little; but no splat goes round the edge where both leaves of the surface are
/// deep. At 100° two scans take 1 and 2 % more bytes.
const KNIFE: f64 = -0.5;

/// A leaf is deep that reaches farther than this from its edge, in bounds: a little more than splats may stand out by.
/// At 1, the folded triangles of a scan are knife edges too, and it takes 2 % more bytes.
const DEEP: f64 = 1.5;

/// A line does not end on an edge, as straight on, whose faces turn from each other by more than this (cosine of the
/// [default angle](crate::tolerance::DEFAULT_EDGE_ANGLE), as sharp as those that lines begin with). At 60° the jaw of a
/// skeleton is cut beside the end of one; files of scans and bones are 1 % larger to 1.4 % smaller.
const ONWARD: f64 = 0.766;

/// Edges of a chain that are looked at, evenly spread.
const LOOKED_AT: usize = 12;

/// A chain is worth a cut if more than one in so many of those is.
const FINE: usize = 2;

/// The same for one made of long straight runs: facets that long meet at others as sharp, which hide how well
/// splats would fit. With 2 and 12, files of coarse meshes are up to 37 and 9 % larger.
const COARSE: usize = 4;

/// Unmarks the chains of feature edges that are not worth a cut. Of those made up of straight runs at least
/// so `long`, model units, fewer sharp places are asked for.
pub fn drop_needless(welded: &Welded, edges: &Edges, worth: &Worth<'_>, long: f64, marked: &mut [bool]) {
    let chains = chains(welded.positions.len(), edges, marked);
    let judge = Judge { edges, patches: Patches::new(welded, edges, marked), worth };
    let needless: Vec<bool> = chains
        .par_iter()
        .map_init(
            || Marks::new(welded.triangles.len()),
            |visited, chain| {
                let every = chain.edges.len().div_ceil(LOOKED_AT);
                let looked_at = chain.edges.iter().skip(every / 2).step_by(every);
                let sharp = looked_at.clone().filter(|&&edge| judge.is_sharp(edge, visited)).count();
                let decisive = if chain.is_coarse(&welded.positions, long) { COARSE } else { FINE };
                decisive * sharp <= looked_at.count()
            },
        )
        .collect();
    let drop = |chain: &Chain| chain.edges.iter().for_each(|&edge| marked[edge as usize] = false);
    chains.iter().zip(needless).filter(|(_, needless)| *needless).map(|(chain, _)| chain).for_each(drop);
}

/// Marks folds that are worth a cut and sharp or lead on from a feature edge or border: splats are cut along them
/// whether or not they are lines, and those that touch a line are to be cut along lines alone. Beyond the end of a line
/// any edge as sharp as feature edges are is worth one: the surface is cut open there, and seen to be.
pub fn mark_folds(welded: &Welded, edges: &Edges, worth: &Worth<'_>, marked: &mut [bool]) {
    let judge = Judge { edges, patches: Patches::new(welded, edges, marked), worth };
    let turn = |visited: &mut Marks, edge| judge.turn(edge, visited);
    let turns: Vec<Option<Turn>> =
        edges.edges.par_iter().map_init(|| Marks::new(welded.triangles.len()), turn).collect();
    let is = |edge: usize, what: fn(&Turn) -> bool| turns[edge].as_ref().is_some_and(what);
    for (edge, mark) in marked.iter_mut().enumerate() {
        *mark |= is(edge, |turn| turn.misses && turn.cosine < SHARP_FOLD);
    }
    let mut open: Vec<u32> = edges.cut(marked).flat_map(|edge| edge.ends).collect();
    let worthy = EdgePaths::new(welded, edges, |edge| is(edge, |turn| turn.misses));
    let all = EdgePaths::new(welded, edges, |_| true);
    // What leads on where a line ends.
    let onward = |vertex: u32, marked: &[bool]| {
        let mut bounding = all.bounding(vertex, marked);
        let line = bounding.next().filter(|_| bounding.next().is_none())?;
        all.onward(line, vertex).filter(|&on| is(on as usize, |turn| turn.cosine < ONWARD))
    };
    while let Some(vertex) = open.pop() {
        for fold in onward(vertex, marked).into_iter().chain(worthy.around(vertex).iter().copied()) {
            if !std::mem::replace(&mut marked[fold as usize], true) {
                open.push(worthy.beyond(fold, vertex));
            }
        }
    }
}

/// How the surface turns at an edge.
struct Turn {
    /// The cosine of the angle by which the two faces turn from each other.
    cosine: f64,
    /// Whether it folds, and no splat goes over both.
    misses: bool,
}

/// What judges the edges of a mesh.
struct Judge<'a> {
    edges: &'a Edges,
    patches: Patches<'a>,
    worth: &'a Worth<'a>,
}

impl Judge<'_> {
    /// Whether splats that stop at an edge reach farther than one that goes over it.
    fn is_sharp(&self, index: u32, visited: &mut Marks) -> bool {
        let worth = self.worth;
        let edge = &self.edges.edges[index as usize];
        let (Some((left, right)), Some(turn)) = (self.edges.pair(edge), self.turn(edge, visited)) else {
            return true;
        };
        let middle = self.patches.middle(edge);
        let mut misfit = |radius: f64, over: bool, faces: &[u32]| {
            let patch = self.patches.patch(&Disc { middle, radius, over }, faces, visited);
            patch.map_or(f64::INFINITY, |(points, normal)| (worth.misfit)(&points, normal))
        };
        if turn.misses {
            // Nothing that is lower than the bound keeps splats from going over it.
            return misfit(OVER * worth.reach, true, &[left.face, right.face]) > worth.max_error;
        }
        let fitted = DEPTHS.iter().map(|share| share * worth.reach).filter_map(|depth| {
            let beside = [left.face, right.face].map(|face| misfit(depth, false, &[face]));
            let beside = beside[0].max(beside[1]);
            (beside <= worth.max_error).then(|| {
                let over = misfit(OVER * depth, true, &[left.face, right.face]);
                over > (LEAST_MISS * worth.max_error).max(SHARPER * beside)
            })
        });
        fitted.take(DECISIVE).reduce(|deeper, next| deeper || next).unwrap_or(turn.cosine < FOLD)
    }

    /// How the surface turns at an edge, where exactly two faces meet.
    fn turn(&self, edge: &Edge, visited: &mut Marks) -> Option<Turn> {
        let (left, right) = self.edges.pair(edge)?;
        let cosine = self.patches.turned(left.face, right.face);
        let mut is_knife = || cosine < KNIFE && [left, right].iter().all(|&side| self.is_deep(side, visited));
        Some(Turn { cosine, misses: cosine < FOLD && (is_knife() || self.misses([left.face, right.face])) })
    }

    /// Whether the leaf of the surface on one side of an edge is deep.
    fn is_deep(&self, side: Half, visited: &mut Marks) -> bool {
        self.patches.reaches(side, DEEP * self.worth.max_error, visited)
    }

    /// Whether a splat over two faces misses them by too much.
    fn misses(&self, faces: [u32; 2]) -> bool {
        let places: Vec<DVec3> = faces.iter().flat_map(|&face| self.patches.lattice(face)).collect();
        let normal = self.patches.mean_normal(faces);
        normal == DVec3::ZERO || (self.worth.misfit)(&places, normal) > LEAST_MISS * self.worth.max_error
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use glam::Vec3;

    /// Steps along a prism.
    const LENGTH: u32 = 40;

    /// A prism over a profile of places `(x, y)`, in steps of half a unit.
    fn prism(profile: &[(f32, f32)]) -> Welded {
        let rows = (0..=LENGTH)
            .flat_map(|step| profile.iter().map(move |&(x, y)| Vec3::new(x, y, 0.5 * step as f32)));
        let across = profile.len() as u32;
        let triangles = (0..LENGTH)
            .flat_map(|step| (0..across - 1).map(move |n| step * across + n))
            .flat_map(|at| [[at, at + 1, at + across], [at + 1, at + across + 1, at + across]]);
        Welded { positions: rows.collect(), triangles: triangles.collect(), ..Welded::default() }
    }

    /// Edges kept of those along a prism at some places of its profile, and how many there are.
    fn kept(profile: &[(f32, f32)], creases: &[u32], misfit: &Misfit<'_>) -> (usize, usize) {
        kept_if(profile, creases, misfit, f64::INFINITY)
    }

    /// The same where straight runs at least so `long` are those of a coarse mesh.
    fn kept_if(profile: &[(f32, f32)], creases: &[u32], misfit: &Misfit<'_>, long: f64) -> (usize, usize) {
        let welded = prism(profile);
        let edges = Edges::of(&welded.triangles);
        let across = profile.len() as u32;
        let crease = |[a, b]: [u32; 2]| a % across == b % across && creases.contains(&(a % across));
        let mut marked: Vec<bool> = edges.edges.iter().map(|edge| crease(edge.ends)).collect();
        let all = marked.iter().filter(|mark| **mark).count();
        let worth = Worth { reach: 6.0, max_error: 0.2, misfit };
        drop_needless(&welded, &edges, &worth, long, &mut marked);
        (marked.iter().filter(|mark| **mark).count(), all)
    }

    /// How well a plane through the mean fits.
    fn plane(places: &[DVec3], normal: DVec3) -> f64 {
        let mean = places.iter().sum::<DVec3>() / places.len() as f64;
        places.iter().map(|place| (*place - mean).dot(normal).abs()).fold(0.0, f64::max)
    }

    /// How well a parabola across a prism fits, upright.
    fn parabola(places: &[DVec3], _: DVec3) -> f64 {
        let mean = places.iter().sum::<DVec3>() / places.len() as f64;
        let terms = |place: &DVec3| DVec3::new(1.0, place.x - mean.x, (place.x - mean.x).powi(2));
        let (mut normal, mut right) = (glam::DMat3::ZERO, DVec3::ZERO);
        for place in places {
            let row = terms(place);
            normal += glam::DMat3::from_cols(row.x * row, row.y * row, row.z * row);
            right += place.y * row;
        }
        let solved = normal.inverse() * right;
        places.iter().map(|place| (place.y - terms(place).dot(solved)).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn the_teeth_of_a_rack_are_worth_their_cuts() {
        // A parabola fits any two flanks, and none fits three.
        let rack: Vec<(f32, f32)> =
            (-20..=20_i8).map(|n| (0.5 * f32::from(n), 0.5 * f32::from(n.rem_euclid(2)))).collect();
        let creases: Vec<u32> = (1..40).collect();
        let all = 39 * LENGTH as usize;
        assert_eq!(kept(&rack, &creases, &parabola), (all, all));
    }

    #[test]
    fn the_edge_of_two_planes_is_worth_a_cut() {
        let roof: Vec<(f32, f32)> =
            (-10..=10_i8).map(|n| (f32::from(n), -0.5 * f32::from(n).abs())).collect();
        assert_eq!(kept(&roof, &[10], &plane), (LENGTH as usize, LENGTH as usize));
    }

    #[test]
    fn an_edge_is_worth_a_cut_though_the_surface_beside_it_bends_as_much_as_a_splat_can() {
        let bent = |x: f32| if x > 0.0 { -0.6 * x - 0.06 * x.powi(3) } else { 0.0 };
        let lip: Vec<(f32, f32)> = (-20..=20_i8).map(|n| 0.25 * f32::from(n)).map(|x| (x, bent(x))).collect();
        assert_eq!(kept(&lip, &[20], &parabola), (LENGTH as usize, LENGTH as usize));
        let smooth: Vec<(f32, f32)> = lip.iter().map(|&(x, _)| (x, -0.06 * x.powi(3))).collect();
        assert_eq!(kept(&smooth, &[20], &parabola), (0, LENGTH as usize), "where it only bends");
    }

    #[test]
    fn a_ridge_lower_than_the_bound_is_not() {
        let ridge: Vec<(f32, f32)> =
            (-50..=50_i8).map(|n| (0.2 * f32::from(n), if n == 0 { 0.15 } else { 0.0 })).collect();
        assert_eq!(kept(&ridge, &[50], &plane), (0, LENGTH as usize));
    }

    #[test]
    fn a_facet_s_edge_of_a_rod_is_not() {
        // Eight facets to a half turn, nowhere flatter than at the edge that is looked at.
        let rod: Vec<(f32, f32)> = (0..=8_u8)
            .map(|n| std::f32::consts::PI * f32::from(n) / 8.0)
            .map(|angle| (-2.0 * angle.cos(), 2.0 * angle.sin()))
            .collect();
        assert_eq!(kept(&rod, &[4], &plane), (0, LENGTH as usize));
    }

    #[test]
    fn where_nothing_fits_beside_a_crease_its_angle_decides() {
        let roof = |slope: f32| -> Vec<(f32, f32)> {
            (-10..=10_i8).map(|n| (f32::from(n), -slope * f32::from(n).abs())).collect()
        };
        let nothing = |_: &[DVec3], _: DVec3| f64::INFINITY;
        assert_eq!(kept(&roof(0.61), &[10], &nothing).0, LENGTH as usize, "63 degrees");
        assert_eq!(kept(&roof(0.54), &[10], &nothing).0, 0, "57 degrees");
    }

    #[test]
    fn a_fold_is_worth_a_cut_however_badly_splats_fit_beside_it() {
        let roof = |slope: f32| -> Vec<(f32, f32)> {
            (-10..=10_i8).map(|n| (f32::from(n), -slope * f32::from(n).abs())).collect()
        };
        let poorly = |places: &[DVec3], normal: DVec3| 0.15 + 0.08 * plane(places, normal);
        assert_eq!(kept(&roof(1.0), &[10], &poorly).0, LENGTH as usize, "a right angle");
        assert_eq!(kept(&roof(0.61), &[10], &poorly).0, LENGTH as usize, "63 degrees");
        assert_eq!(kept(&roof(0.54), &[10], &poorly).0, 0, "57 degrees");
        let low: Vec<(f32, f32)> =
            (-50..=50_i8).map(|n| (0.03 * f32::from(n), if n == 0 { 0.04 } else { 0.0 })).collect();
        assert_eq!(kept(&low, &[50], &plane).0, 0, "lower than the bound");
    }

    /// Steps along the ridge of a roof that are marked once folds carry on an edge that leads up to it, if that is
    /// marked, and before and after which all is flat.
    fn carried_on(slope: f32, led: bool, misfit: &Misfit<'_>) -> Vec<u32> {
        let led = led.then_some(FIRST - 1);
        carried_between([FIRST, LAST], slope, led, &Worth { reach: 6.0, max_error: 0.2, misfit })
    }

    /// The same of a ridge between two steps, one of them marked before.
    fn carried_between([first, last]: [u32; 2], slope: f32, led: Option<u32>, worth: &Worth<'_>) -> Vec<u32> {
        // Between two ditches in level ground, so that nothing folds where that ends.
        let depth = |x: f32| slope * x.abs().min(4.0 - x.abs()).max(0.0);
        let roof: Vec<(f32, f32)> = (-10..=10_i8).map(f32::from).map(|x| (x, -depth(x))).collect();
        let across = roof.len() as u32;
        let mut welded = prism(&roof);
        for (step, row) in (0..).zip(welded.positions.chunks_exact_mut(roof.len())) {
            row.iter_mut().filter(|_| !(first..=last).contains(&step)).for_each(|place| place.y = 0.0);
        }
        let edges = Edges::of(&welded.triangles);
        let ridge = |step: u32| edges.find(step * across + 10, (step + 1) * across + 10).unwrap();
        let mut marked = vec![false; edges.edges.len()];
        led.into_iter().for_each(|step| marked[ridge(step)] = true);
        mark_folds(&welded, &edges, worth, &mut marked);
        (0..LENGTH).filter(|&step| marked[ridge(step)]).collect()
    }

    /// Where the ridge begins and ends.
    const FIRST: u32 = 10;
    const LAST: u32 = 30;

    /// Whether the ridge is marked from end to end, with or without the slopes where it rises and falls.
    fn is_whole(marked: &[u32]) -> bool {
        (FIRST..LAST).all(|step| marked.contains(&step))
            && marked.iter().all(|step| (FIRST - 1..=LAST).contains(step))
    }

    #[test]
    fn folds_lead_on_from_lines_and_borders_and_from_nowhere_else() {
        assert!(is_whole(&carried_on(1.0, true, &plane)));
        assert!(carried_on(1.0, false, &plane).is_empty(), "it leaves no line");
        let worth = Worth { reach: 6.0, max_error: 0.2, misfit: &plane };
        assert_eq!(carried_between([0, LAST], 1.0, None, &worth), (0..=LAST).collect::<Vec<_>>());
    }

    #[test]
    fn a_sharp_fold_is_a_line_wherever_it_lies() {
        assert!(is_whole(&carried_on(1.3, false, &plane)), "105 degrees");
        assert!(carried_on(1.1, false, &plane).is_empty(), "95 degrees");
        let nothing = |_: &[DVec3], _: DVec3| 0.0;
        assert!(carried_on(1.3, false, &nothing).is_empty(), "lower than the bound");
    }

    #[test]
    fn a_knife_edge_of_deep_leaves_is_a_line_though_no_splat_misses_its_faces() {
        let nothing = |_: &[DVec3], _: DVec3| 0.0;
        // On either side go down two steps of one unit across, each some 2.8 long.
        let marked = |slope: f32, max_error: f64| {
            let worth = Worth { reach: 6.0, max_error, misfit: &nothing };
            carried_between([FIRST, LAST], slope, None, &worth)
        };
        assert!(is_whole(&marked(2.6, 0.2)), "138 degrees");
        assert!(is_whole(&marked(2.6, 3.5)), "over both steps of a leaf");
        assert!(marked(2.6, 3.8).is_empty(), "leaves less than one and a half bounds deep");
        assert!(marked(1.6, 0.2).is_empty(), "116 degrees");
    }

    #[test]
    fn a_line_does_not_end_on_a_sharp_edge() {
        let nothing = |_: &[DVec3], _: DVec3| 0.0;
        assert!(is_whole(&carried_on(1.4, true, &nothing)));
        assert!(carried_on(1.4, false, &nothing).is_empty(), "it leaves no line");
        assert!(is_whole(&carried_on(0.4, true, &nothing)), "44 degrees");
        assert_eq!(carried_on(0.3, true, &nothing), [FIRST - 1], "33 degrees");
    }

    #[test]
    fn of_a_long_straight_fold_fewer_places_need_be_sharp() {
        let roof: Vec<(f32, f32)> =
            (-10..=10_i8).map(|n| (f32::from(n), -0.5 * f32::from(n).abs())).collect();
        let whole = 0.5 * f64::from(LENGTH);
        let sharp_up_to = |share: f64, long: f64| {
            let misfit = |places: &[DVec3], normal: DVec3| {
                let mean = places.iter().map(|place| place.z).sum::<f64>() / places.len() as f64;
                if mean < share * whole { plane(places, normal) } else { 0.0 }
            };
            kept_if(&roof, &[10], &misfit, long).0
        };
        assert_eq!((sharp_up_to(0.4, whole), sharp_up_to(0.4, 1.1 * whole)), (LENGTH as usize, 0));
        assert_eq!(sharp_up_to(0.2, whole), 0, "too few even so");
    }
}
