//! Looking at splats as a user will, and when that is worth its time.

use std::ops::Range;

use super::kept::Kept;
use super::options::{Holes, Options};
use crate::error::Result;
use crate::fit::clip::Clips;
use crate::model::asset::Asset;
use crate::model::sight::Faults;
use crate::tolerance::COARSEST_CLOSED;

/// Whoever looks at an asset beside the input.
pub trait Looking {
    /// Looks at what a bake keeps of the input, or of what stands in for that, before it is covered.
    ///
    /// # Errors
    /// For an input that cannot be looked at.
    fn at(&mut self, kept: &Kept<'_>) -> Result<()>;

    /// The rays on which more or less is seen of an asset than of that.
    ///
    /// # Errors
    /// For an asset that cannot be looked at.
    fn faults(&mut self, asset: &Asset) -> Result<Faults>;
}

/// Sees nothing.
pub struct Blind;

impl Looking for Blind {
    fn at(&mut self, _: &Kept<'_>) -> Result<()> {
        Ok(())
    }

    fn faults(&mut self, _: &Asset) -> Result<Faults> {
        Ok(Faults::default())
    }
}

/// Pixels that points of a cloud stand for around them, between which it is looked at.
///
/// Of denser ones, 2 million points of fandisk and 4 million of a head at 0.1 %, no pixel is missing or extra, and 8 and
/// 26 of 6.7 million are seen through; to look takes as long as to find all neighbours. Sparser ones have
/// discs that take longer to draw than such a cloud takes to bake, and mending changes little: 60,000 points of fandisk
/// have 4 pixels extra at 0.3 and at 0.03 %, and had 4 and 2.
const PIXELS: Range<f64> = 0.5..2.5;

/// Whether faults are looked for at all.
pub(super) fn is_looked_at(options: &Options) -> bool {
    // What partners cut away is not known before they are found.
    options.holes == Holes::Close && options.clips != Clips::Partners
}

/// The median margins, model units, of a cloud that is looked at; `None` where `noise` says that it shows no
/// surface, or nothing is looked at.
pub(super) fn told_margins(options: &Options, noise: Option<f64>, diagonal: f64) -> Option<Range<f64>> {
    let pixel = COARSEST_CLOSED * diagonal;
    noise.filter(|_| is_looked_at(options)).map(|_| PIXELS.start * pixel..PIXELS.end * pixel)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::bake::analysed::analyse;
    use crate::bake::bound::diagonal;
    use crate::bake::scattered::sphere;
    use crate::bake::{meant, model_error};
    use crate::ingest::Input;

    #[test]
    fn clouds_are_looked_at_where_they_tell_what_a_pixel_shows() {
        let looked = |count: u64, options: &Options| {
            let input = Input::Cloud(sphere(count, 0.0));
            let (diagonal, bound) =
                (diagonal(&input.cloud().positions), model_error(options, &input).unwrap());
            let meant = meant(&input, options, bound).unwrap();
            analyse(&meant, options, bound, diagonal).unwrap().discs.is_some()
        };
        let [close, leave] =
            [Holes::Close, Holes::Leave].map(|holes| Options { holes, ..Options::default() });
        assert_eq!([20_000, 100_000, 1_600_000].map(|count| looked(count, &close)), [false, true, false]);
        let partners = Options { clips: Clips::Partners, ..Options::default() };
        assert!(!looked(100_000, &leave) && !looked(100_000, &partners));
    }
}
