//! The Pareto front: the settings that no other setting beats.

/// Which of some `(cost, error)` pairs no other beats, being at most as large in both and
/// smaller in one. Pairs with a NaN are never on the front. Equal pairs stand or fall together.
#[must_use]
pub fn front(pairs: &[(f64, f64)]) -> Vec<bool> {
    let beats = |a: &(f64, f64), b: &(f64, f64)| a.0 <= b.0 && a.1 <= b.1 && (a.0 < b.0 || a.1 < b.1);
    pairs
        .iter()
        .map(|pair| !pair.0.is_nan() && !pair.1.is_nan() && !pairs.iter().any(|other| beats(other, pair)))
        .collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_planted_front_is_found() {
        let pairs = [(1.0, 9.0), (2.0, 9.0), (2.0, 4.0), (3.0, 4.0), (5.0, 1.0), (5.0, 1.0), (9.0, f64::NAN)];
        assert_eq!(front(&pairs), [true, false, true, false, true, true, false]);
        assert_eq!(front(&[]), Vec::<bool>::new());
        assert_eq!(front(&[(1.0, 1.0)]), [true]);
    }

    proptest! {
        /// By the other way to find it: in order of cost, the front is where the error falls below
        /// everything before.
        #[test]
        fn the_front_is_a_falling_staircase(pairs in prop::collection::vec((0_u8..12, 0_u8..12), 0..30)) {
            let pairs: Vec<(f64, f64)> = pairs.into_iter().map(|(c, e)| (c.into(), e.into())).collect();
            let found = front(&pairs);
            for (n, pair) in pairs.iter().enumerate() {
                let cheaper = pairs.iter().filter(|p| p.0 < pair.0).map(|p| p.1).fold(f64::MAX, f64::min);
                let as_cheap = pairs.iter().filter(|p| p.0 <= pair.0).map(|p| p.1).fold(f64::MAX, f64::min);
                prop_assert_eq!(found[n], pair.1 < cheaper && pair.1 <= as_cheap);
            }
        }
    }
}
