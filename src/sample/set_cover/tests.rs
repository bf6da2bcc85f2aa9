//! The search against optima that are known.
#![allow(clippy::unwrap_used)]

use super::*;
use crate::analyse::canonical::mix;

/// The cheapest of all choices that cover some pieces.
pub(in crate::sample) fn cheapest(costs: &[f64], covered: &[Vec<u32>], pieces: usize) -> f64 {
    let masks: Vec<u32> = covered.iter().map(|set| set.iter().map(|piece| 1 << piece).sum()).collect();
    let all = (1_u32 << pieces) - 1;
    let mut least = vec![f64::INFINITY; 1 << pieces];
    least[0] = 0.0;
    for have in 0..all as usize {
        for (mask, cost) in masks.iter().zip(costs) {
            let with = have | *mask as usize;
            least[with] = least[with].min(least[have] + cost);
        }
    }
    least[all as usize]
}

fn problem(costs: &[f64], covered: &[Vec<u32>], pieces: usize) -> SetCover {
    let covered: Vec<&[u32]> = covered.iter().map(Vec::as_slice).collect();
    SetCover::of_decisive(costs.to_vec(), &Alike::of(&covered, pieces))
}

fn covers_all(chosen: &[u32], covered: &[Vec<u32>], pieces: u32) -> bool {
    let has = |piece| chosen.iter().any(|&index| covered[index as usize].contains(&piece));
    (0..pieces).all(has)
}

/// Some candidates of up to four of some pieces, and one of each piece alone.
fn random(seed: u64, pieces: u32, candidates: u64) -> (Vec<f64>, Vec<Vec<u32>>) {
    let draw = |n: u64, below: u64| mix(mix(seed) ^ n) % below;
    let several = (0..candidates).map(|at| {
        let mut set: Vec<u32> = (0..4).map(|k| draw(8 * at + k, u64::from(pieces)) as u32).collect();
        set.sort_unstable();
        set.dedup();
        (5.0 + draw(8 * at + 5, 12) as f64, set)
    });
    several.chain((0..pieces).map(|piece| (9.0, vec![piece]))).unzip()
}

/// A cover by price a piece newly covered, and no price on pieces.
fn greedy(problem: &SetCover) -> Vec<u32> {
    problem.greedy(&vec![0.0; problem.pieces])
}

#[test]
fn small_covers_are_nearly_always_the_best() {
    const CASES: u64 = 300;
    let (mut best, mut best_of_greed) = (0, 0);
    for seed in 0..CASES {
        let (costs, covered) = random(seed, 12, 30);
        let problem = problem(&costs, &covered, 12);
        let optimum = cheapest(&costs, &covered, 12);
        let known = greedy(&problem);
        let found = problem.cheaper(known.clone());
        assert!(covers_all(&found, &covered, 12) && covers_all(&known, &covered, 12));
        let (before, after) = (problem.cost(&known), problem.cost(&found));
        assert!(after <= before && after > optimum - 1e-9, "{before} to {after}, at best {optimum}");
        best += u64::from(after < optimum + 1e-9);
        best_of_greed += u64::from(before < optimum + 1e-9);
    }
    assert!(best >= CASES * 95 / 100, "{best} of {CASES} are optima");
    assert!(best_of_greed < CASES / 2, "greed alone finds {best_of_greed} of {CASES}");
}

#[test]
fn greed_looks_at_prices_and_the_dearest_redundant_go_first() {
    let sets = vec![vec![0, 1, 2], vec![1, 2, 3], vec![3], vec![0]];
    let problem = problem(&[6.0, 5.0, 4.0, 4.0], &sets, 4);
    assert_eq!(problem.greedy(&vec![0.0; problem.pieces]), [1, 3]);
    // Pieces 1 and 2 are one, and priced so high that the first is below its price.
    assert_eq!(problem.greedy(&[2.0, 4.5, 0.0]), [0, 2]);
    assert_eq!(problem.pruned(vec![0, 1, 2, 3]), [1, 3]);
}

/// Candidates in a long row, each of which reaches over some pieces.
fn row() -> (SetCover, Vec<Vec<u32>>) {
    let (costs, covered): (Vec<f64>, Vec<Vec<u32>>) =
        (0..4000_u32).map(|at| (f64::from(7 + at * at % 13), (at..=at + 3 + at % 11).collect())).unzip();
    (problem(&costs, &covered, 4011), covered)
}

#[test]
fn a_long_row_is_covered_for_less_the_same_whatever_the_threads() {
    let (problem, covered) = row();
    let known = greedy(&problem);
    let at = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| problem.cheaper(known.clone()))
    };
    let found = at(1);
    assert!(found == at(2) && found == at(5));
    assert!(covers_all(&found, &covered, 4000));
    // Intervals cost as much in fractions as whole, so that the ascent ends at the optimum.
    let peak = problem.ascend(problem.feasible(), problem.cost(&found), 2000, |_, _| ());
    let (cost, least) = (problem.cost(&found), peak.bound);
    assert!(cost < problem.cost(&known) && cost < 1.005 * least, "{cost}, at best {least}");
}

#[test]
fn neighbourhoods_divide_a_cover_and_its_pieces() {
    let (problem, _) = row();
    let chosen = greedy(&problem);
    let divided = |round| problem.neighbourhoods(&chosen, 20, round);
    for round in 0..3 {
        let parts = divided(round);
        let mut all = parts.iter().flat_map(|part| part.chosen.clone()).collect::<Vec<_>>();
        all.sort_unstable();
        assert_eq!(all, chosen);
        let mut pieces = parts.iter().flat_map(|part| part.pieces.clone()).collect::<Vec<_>>();
        pieces.sort_unstable();
        assert_eq!(pieces, (0..problem.pieces as u32).collect::<Vec<_>>());
        for part in &parts {
            assert!((1..=20).contains(&part.chosen.len()));
            let mut own = part.pieces.iter().map(|&piece| problem.covering.row(piece));
            assert!(own.all(|row| row.iter().any(|index| part.chosen.contains(index))));
        }
    }
    let shape = |round| divided(round).into_iter().map(|part| part.chosen).collect::<Vec<_>>();
    assert!(shape(0) != shape(1));
}
