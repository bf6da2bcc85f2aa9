//! The bounds against optima that are known.
#![allow(clippy::unwrap_used)]

use proptest::prelude::*;

use super::*;
use crate::sample::set_cover::tests::cheapest;

/// Bounds of a cover of pieces of the same area.
fn bound(costs: &[f64], covered: &[Vec<u32>], pieces: usize, spent: f64) -> LowerBound {
    bound_of(costs, covered, &vec![1.0; pieces], spent)
}

fn bound_of(costs: &[f64], covered: &[Vec<u32>], areas: &[f64], spent: f64) -> LowerBound {
    let covered: Vec<&[u32]> = covered.iter().map(Vec::as_slice).collect();
    Problem { costs, covered: &covered, areas }.bound(spent)
}

/// Bounds hold up to the rounding of sums.
const ROUNDING: f64 = 1.0 + 1e-12;

fn assert_at(found: f64, optimum: f64, share: f64) {
    assert!(found <= optimum * ROUNDING, "{found} is above {optimum}");
    assert!(found >= (1.0 - share) * optimum, "{found} is far below {optimum}");
}

#[test]
fn an_odd_cycle_costs_half_a_candidate_less_in_fractions() {
    let cycle = vec![vec![0, 1], vec![1, 2], vec![0, 2]];
    let found = bound(&[1.0; 3], &cycle, 3, 2.0);
    assert_at(found.lagrangian, 1.5, 1e-3);
    assert_at(found.area, 1.5, 1e-9);
    assert!((found.cost - 2.0).abs() < 1e-12 && found.rounds > 0);
    assert!((found.excess() - 1.0 / 3.0).abs() < 1e-3);
    let five = (0..5_u32).map(|at| if at < 4 { vec![at, at + 1] } else { vec![0, 4] }).collect::<Vec<_>>();
    assert_at(bound(&[2.0; 5], &five, 5, 6.0).lagrangian, 5.0, 1e-3);
}

#[test]
fn weights_turn_the_choice() {
    // In fractions as in whole: the large one for 5 beats 3 + 3, and loses to 2 + 2.
    let sets = vec![vec![0, 1, 2, 3], vec![0, 1], vec![2, 3]];
    assert_at(bound(&[5.0, 3.0, 3.0], &sets, 4, 6.0).lagrangian, 5.0, 1e-3);
    assert_at(bound(&[5.0, 2.0, 2.0], &sets, 4, 5.0).lagrangian, 4.0, 1e-3);
    // A weighted odd cycle: all multipliers at half of what the two candidates around leave.
    let cycle = vec![vec![0, 1], vec![1, 2], vec![0, 2]];
    assert_at(bound(&[3.0, 4.0, 5.0], &cycle, 3, 7.0).lagrangian, 6.0, 1e-3);
}

#[test]
fn the_area_bound_prices_each_piece_at_its_best_candidate() {
    // Four of area for 2, two of area for 3: piece 1 is priced by the former.
    let sets = vec![vec![0, 1], vec![1, 2]];
    let found = bound_of(&[2.0, 3.0], &sets, &[3.0, 1.0, 1.0], 5.0);
    assert_at(found.area, 3.0 * 0.5 + 0.5 + 1.5, 1e-12);
    assert_at(found.lagrangian, 5.0, 1e-3);
}

#[test]
fn a_piece_without_area_still_has_to_be_covered() {
    let found = bound_of(&[2.0, 3.0], &[vec![0], vec![1]], &[0.0, 1.0], 5.0);
    assert_at(found.area, 3.0, 1e-12);
    assert_at(found.lagrangian, 5.0, 1e-5);
}

#[test]
fn what_none_covers_and_no_candidates_at_all_bound_nothing() {
    assert_at(bound(&[2.0], &[vec![1]], 3, 2.0).lagrangian, 2.0, 1e-5);
    let nothing = bound(&[], &[], 2, 0.0);
    assert!(nothing.lagrangian.abs() < 1e-300 && nothing.area.abs() < 1e-300 && nothing.excess() < 1e-300);
}

/// Candidates, each of a cost and the pieces it covers.
type Sets = Vec<(f64, Vec<u32>)>;

/// Lists of candidates over some pieces, each piece covered by one at least.
fn covers(pieces: u32, candidates: usize) -> impl Strategy<Value = Sets> {
    let one = (1..30_u32, proptest::collection::btree_set(0..pieces, 1..5));
    proptest::collection::vec(one, 1..candidates).prop_map(move |list| {
        let mut sets: Sets =
            list.into_iter().map(|(cost, set)| (f64::from(cost), set.into_iter().collect())).collect();
        sets.push((40.0, (0..pieces).collect()));
        sets
    })
}

/// The cheapest cover of `pieces` by intervals `start..end`.
fn cheapest_intervals(intervals: &[(f64, u32, u32)], pieces: usize) -> f64 {
    let mut least = vec![f64::INFINITY; pieces + 1];
    least[0] = 0.0;
    for covered in 0..pieces {
        for &(cost, start, end) in intervals.iter().filter(|interval| interval.1 as usize <= covered) {
            for reached in covered + 1..=end as usize {
                least[reached] = least[reached].min(least[covered] + cost);
            }
            debug_assert!(start < end);
        }
    }
    least[pieces]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn no_cover_costs_less(sets in covers(10, 14), areas in proptest::collection::vec(0.0..2.0, 10)) {
        let (costs, covered): (Vec<f64>, Vec<Vec<u32>>) = sets.into_iter().unzip();
        let optimum = cheapest(&costs, &covered, 10);
        let found = bound_of(&costs, &covered, &areas, 1.2 * optimum);
        prop_assert!(found.lagrangian <= optimum * ROUNDING, "{found:?} above {optimum}");
        prop_assert!(found.area <= found.lagrangian);
    }

    /// Intervals have a totally unimodular matrix: in fractions they cost as much as whole.
    #[test]
    fn intervals_are_bounded_by_their_optimum(
        list in proptest::collection::vec((5..30_u32, 0..60_u32, 1..15_u32), 20..80),
    ) {
        const PIECES: u32 = 60;
        let pieces = PIECES as usize;
        let mut intervals: Vec<(f64, u32, u32)> =
            list.into_iter().map(|(cost, at, length)| (f64::from(cost), at, PIECES.min(at + length))).collect();
        intervals.extend((0..PIECES).map(|at| (40.0, at, at + 1)));
        let costs: Vec<f64> = intervals.iter().map(|interval| interval.0).collect();
        let covered: Vec<Vec<u32>> = intervals.iter().map(|&(_, start, end)| (start..end).collect()).collect();
        let optimum = cheapest_intervals(&intervals, pieces);
        let found = bound(&costs, &covered, pieces, 1.1 * optimum);
        prop_assert!(found.lagrangian <= optimum * ROUNDING, "{found:?} above {optimum}");
        // Mostly within a percent, but steps may become too small before they are there.
        prop_assert!(found.lagrangian >= 0.95 * optimum, "{found:?} far below {optimum}");
    }
}

#[test]
fn the_bound_is_the_same_whatever_the_threads() {
    // More candidates than one thread works out at a time.
    let (costs, covered): (Vec<f64>, Vec<Vec<u32>>) =
        (0..4000_u32).map(|at| (f64::from(7 + at * at % 13), (at..=at + 3 + at % 11).collect())).unzip();
    let at = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| bound(&costs, &covered, 4014, 20_000.0))
    };
    assert!(at(1).lagrangian > at(1).area);
    assert!(at(1) == at(2) && at(1) == at(5));
}
