//! Pieces that the same candidates cover.

/// The first of each lot of pieces that exactly the same candidates cover, ascending, but for those
/// that none covers. `covered` lists the pieces of each candidate, nothing twice.
///
/// Candidate by candidate, each lot is split into what it covers and what not. Next to no time
/// beside listing the candidates of each piece, which of a dense cloud are millions.
pub(super) fn unlike(covered: &[&[u32]], pieces: usize) -> Vec<u32> {
    // All begin in lot 0, and those that are never taken out of it have no candidate.
    let mut lots = vec![0_u32; pieces];
    let mut splits = vec![Split::default()];
    for (candidate, covered) in (1_u32..).zip(covered) {
        for &piece in *covered {
            let lot = &mut lots[piece as usize];
            let newest = splits.len() as u32;
            let split = &mut splits[*lot as usize];
            if split.by != candidate {
                *split = Split { by: candidate, into: newest };
                splits.push(Split::default());
            }
            *lot = splits[*lot as usize].into;
        }
    }
    let mut met = vec![false; splits.len()];
    met[0] = true;
    let mut first = |piece: &u32| !std::mem::replace(&mut met[lots[*piece as usize] as usize], true);
    (0..pieces as u32).filter(|piece| first(piece)).collect()
}

/// Where those of a lot go that a candidate covers.
#[derive(Clone, Copy, Default)]
struct Split {
    /// The candidate, counted from 1.
    by: u32,
    into: u32,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_stands_for_all_that_the_same_candidates_cover() {
        // Pieces 1 and 4 by both, 2 and 3 by the first, 5 by the last, 0 by none.
        let covered: [&[u32]; 2] = [&[1, 2, 3, 4], &[1, 4, 5]];
        assert_eq!(unlike(&covered, 6), [1, 2, 5]);
        assert!(unlike(&[], 3).is_empty());
    }
}
