//! `holes`: pixels where only one of input and splats is hit.
//!
//! A pixel is compared unless it lies in the band along the input's silhouette. The silhouette
//! is the outline of the set of pixels whose ray hits the input, and the band is every pixel
//! with one of the other set among its eight neighbours. Where one part of the input hides
//! another, the set has no outline: such pixels are compared.
//!
//! A part of a mesh thinner than a pixel may slip between the rays; its outline is then every pixel that it touches
//! with none of the set around, and the band one more on either side.
//!
//! A cloud tells where its surface is no better than its discs do ([`Prepared::met`]): there the band is
//! as wide as the outline is uncertain. It holds the pixels whose ray may meet the surface and may miss
//! it, and one more on either side.
//!
//! A hole in a closed surface shows the surface's far side, so that both are hit there. Pixels
//! where the splats lie farther behind than all that the input shows in the nine pixels around
//! are counted as seen *through*.

use image::{Rgb, RgbImage};

use crate::model::asset::Asset;
use crate::render::input::Met;
#[cfg(doc)]
use crate::render::input::Prepared;
use crate::render::picture::Visibility;

/// Width of the band along the silhouette on either side, pixels.
const BAND: u32 = 1;

/// Error bounds by which the nearest splat must lie behind the input to be seen through. Two
/// splats over one point are within one bound of it each, at their rims within two.
const BEHIND: f64 = 4.0;

/// What white becomes behind the faults, and by how much contrast is lessened: they stand out.
const PALEST: u8 = 245;
const PALER: u8 = 3;

/// What a pixel came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// In the band along the silhouette: not compared.
    Silhouette,
    /// Both are hit or neither.
    Same,
    /// The input is hit and no splat is.
    Missing,
    /// A splat is hit and the input is not.
    Extra,
    /// Both are hit, the splats far behind.
    Through,
}

impl Mark {
    /// The marks that are faults.
    pub const FAULTS: [Self; 3] = [Self::Missing, Self::Extra, Self::Through];

    /// Colour of a fault in pictures: red, blue, orange.
    #[must_use]
    pub fn color(self) -> Option<Rgb<u8>> {
        match self {
            Self::Missing => Some(Rgb([225, 0, 0])),
            Self::Extra => Some(Rgb([0, 60, 255])),
            Self::Through => Some(Rgb([255, 140, 0])),
            Self::Silhouette | Self::Same => None,
        }
    }
}

/// What each pixel of a view came to, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct HoleMap {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// As many as pixels.
    pub marks: Vec<Mark>,
}

/// How far behind the input, model units, splats are seen through it.
#[must_use]
pub fn behind(asset: &Asset) -> f64 {
    BEHIND * asset.max_error
}

/// How far away the input lies at each pixel: all that is compared of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Depths {
    /// Width and height in pixels.
    size: [u32; 2],
    /// View depths in model units, rows from the top; infinite where the ray may meet nothing.
    depths: Vec<f64>,
    /// As [`Met::perhaps`].
    perhaps: Vec<bool>,
}

impl Depths {
    /// From what the rays of all pixels of a picture of this width and height meet.
    #[must_use]
    pub fn new(size: [u32; 2], met: Met) -> Self {
        Self { size, depths: met.surely, perhaps: met.perhaps }
    }

    /// What a pixel surely shows.
    pub(super) fn at(&self, x: u32, y: u32) -> Option<f64> {
        self.depths.get(y as usize * self.size[0] as usize + x as usize).copied().filter(|d| d.is_finite())
    }
}

/// Compares what an input and splats seen by one camera hit, in pictures of one size.
#[must_use]
pub fn compare(input: &Depths, splats: &Visibility, behind: f64) -> HoleMap {
    let size = input.size;
    let hits = Counts::of(input);
    let marks = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y)));
    let marks = marks.map(|(x, y)| {
        let inside = input.at(x, y);
        match (inside, splats.at(x, y)) {
            _ if !hits.are_compared(x, y, inside.is_some()) => Mark::Silhouette,
            (Some(_), None) => Mark::Missing,
            (None, Some(_)) => Mark::Extra,
            // The first is the quick answer to most, the second the rule.
            (Some(own), Some(hit))
                if hit.depth > own + behind && hit.depth > farthest(input, x, y) + behind =>
            {
                Mark::Through
            }
            _ => Mark::Same,
        }
    });
    HoleMap { size, marks: marks.collect() }
}

/// How deep the ray through each pixel that is asked about may go before it has to be stopped, lest it
/// count as a fault: infinitely beside the input, where nothing may stop it. Minus infinity for pixels that
/// are not asked about or not compared.
///
/// Behind the input the limit is that of the pixel itself; where it is not kept, [`farthest`] decides.
pub(super) fn limits(input: &Depths, asked: &[bool], behind: f64) -> Vec<f64> {
    let hits = Counts::of(input);
    let limit = |(place, &asked): (usize, &bool)| {
        let (x, y) = (place as u32 % input.size[0], place as u32 / input.size[0]);
        let inside = input.at(x, y);
        if asked && hits.are_compared(x, y, inside.is_some()) {
            inside.map_or(f64::INFINITY, |own| own + behind)
        } else {
            f64::NEG_INFINITY
        }
    };
    asked.iter().enumerate().map(limit).collect()
}

/// The greatest depth that the nine pixels around one show.
pub(super) fn farthest(seen: &Depths, x: u32, y: u32) -> f64 {
    let around =
        (y.saturating_sub(1)..=y + 1).flat_map(|y| (x.saturating_sub(1)..=x + 1).map(move |x| (x, y)));
    let inside = around.filter(|&(x, y)| x < seen.size[0] && y < seen.size[1]);
    inside.filter_map(|(x, y)| seen.at(x, y)).fold(f64::NEG_INFINITY, f64::max)
}

impl HoleMap {
    /// How many pixels have a mark.
    #[must_use]
    pub fn count(&self, mark: Mark) -> u64 {
        self.marks.iter().filter(|&&other| other == mark).count() as u64
    }

    /// How many pixels were compared.
    #[must_use]
    pub fn compared(&self) -> u64 {
        self.marks.len() as u64 - self.count(Mark::Silhouette)
    }

    /// The pixels with a fault.
    pub fn faults(&self) -> impl Iterator<Item = (u32, u32)> + '_ {
        self.places(&Mark::FAULTS)
    }

    /// The pixels with one of some marks.
    pub fn places<'a>(&'a self, marks: &'a [Mark]) -> impl Iterator<Item = (u32, u32)> + 'a {
        let marked = self.marks.iter().enumerate().filter(|(_, mark)| marks.contains(mark));
        marked.map(|(n, _)| (n as u32 % self.size[0], n as u32 / self.size[0]))
    }

    /// A picture of the view, pale, with the faults in their colours.
    #[must_use]
    pub fn picture(&self, view: &RgbImage) -> RgbImage {
        let pale = |byte: u8| PALEST - (u8::MAX - byte) / PALER;
        let mut picture = view.clone();
        for (pixel, mark) in picture.pixels_mut().zip(&self.marks) {
            *pixel = mark.color().unwrap_or(Rgb(pixel.0.map(pale)));
        }
        picture
    }
}

/// How many pixels of a view are hit, surely and perhaps, in any rectangle.
struct Counts {
    surely: Sums,
    perhaps: Sums,
}

impl Counts {
    fn of(seen: &Depths) -> Self {
        Self {
            surely: Sums::of(seen.size, seen.depths.iter().map(|depth| depth.is_finite())),
            perhaps: Sums::of(seen.size, seen.perhaps.iter().copied()),
        }
    }

    /// Whether a pixel that is surely hit or not lies off the silhouette's band.
    fn are_compared(&self, x: u32, y: u32, hit: bool) -> bool {
        if hit { self.surely.around(x, y) == WHOLE } else { self.perhaps.around(x, y) == 0 }
    }
}

/// Pixels within the band's width of one.
const WHOLE: u64 = (2 * BAND as u64 + 1).pow(2);

/// How many pixels there are in any rectangle from the corner (a summed-area table, Crow 1984).
struct Sums {
    size: [u32; 2],
    sums: Vec<u32>,
}

impl Sums {
    fn of(size: [u32; 2], mut there: impl Iterator<Item = bool>) -> Self {
        let stride = size[0] as usize + 1;
        let mut sums = vec![0; stride * (size[1] as usize + 1)];
        for y in 0..size[1] as usize {
            let mut along = 0;
            for (x, is_there) in there.by_ref().take(stride - 1).enumerate() {
                along += u32::from(is_there);
                sums[(y + 1) * stride + x + 1] = sums[y * stride + x + 1] + along;
            }
        }
        Self { size, sums }
    }

    /// How many there are within the band's width of one; beyond the picture there are none.
    fn around(&self, x: u32, y: u32) -> u64 {
        let span = |at: u32, side: u32| [at.saturating_sub(BAND), at.saturating_add(BAND + 1).min(side)];
        let ([left, right], [top, bottom]) = (span(x, self.size[0]), span(y, self.size[1]));
        let at = |x: u32, y: u32| u64::from(self.sums[y as usize * (self.size[0] as usize + 1) + x as usize]);
        at(right, bottom) + at(left, top) - at(left, bottom) - at(right, top)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::picture::Seen;

    /// A visibility from rows of `.` for nothing and a digit for a depth.
    fn seen(rows: &[&str]) -> Visibility {
        let hit = |c: char| c.to_digit(10).map(|d| Seen { depth: d.into(), index: d, normal: [0.0; 3] });
        let seen = rows.iter().flat_map(|row| row.chars().map(hit)).collect();
        Visibility { size: [rows[0].len() as u32, rows.len() as u32], seen }
    }

    /// How deep what rays hit lies, where nothing else is touched.
    fn depths(seen: &Visibility) -> Depths {
        let depths = seen.seen.iter().map(|hit| hit.map_or(f64::INFINITY, |hit| hit.depth)).collect();
        Depths { size: seen.size, depths, perhaps: seen.seen.iter().map(Option::is_some).collect() }
    }

    /// The marks as rows.
    fn rows(map: &HoleMap) -> Vec<String> {
        let letter = |mark: &Mark| match mark {
            Mark::Silhouette => '|',
            Mark::Same => ' ',
            Mark::Missing => 'm',
            Mark::Extra => 'e',
            Mark::Through => 't',
        };
        map.marks.chunks_exact(map.size[0] as usize).map(|row| row.iter().map(letter).collect()).collect()
    }

    #[test]
    fn faults_count_off_the_silhouette_alone() {
        let input =
            seen(&["........", "........", "...11111", "...11111", "...11111", "...11111", "...11111"]);
        let splats =
            seen(&["5.......", "........", ".5......", "...11111", "...11.51", "...11111", "..111111"]);
        let map = compare(&depths(&input), &splats, 2.0);
        let expected = ["e       ", "  ||||||", " e||||||", "  ||   |", "  || mt|", "  ||   |", "  ||||||"];
        assert_eq!(rows(&map), expected);
        assert_eq!([Mark::Missing, Mark::Extra, Mark::Through].map(|mark| map.count(mark)), [1, 2, 1]);
        assert_eq!(map.compared(), expected.concat().chars().filter(|&c| c != '|').count() as u64);
        assert_eq!(map.faults().collect::<Vec<_>>(), [(0, 0), (1, 2), (5, 4), (6, 4)]);
    }

    #[test]
    fn depth_beside_a_step_is_not_through() {
        let input = seen(&["1111111", "1111444", "1111444", "1111444", "1111111"]);
        let splats = seen(&["1111111", "1111444", "1114444", "1114414", "1111111"]);
        let near = compare(&depths(&input), &splats, 2.0);
        assert_eq!(near.count(Mark::Through), 0, "the step lies within a pixel");
        let splats = seen(&["1111111", "1144444", "1114444", "1114444", "1111111"]);
        let far = compare(&depths(&input), &splats, 2.0);
        assert_eq!(far.faults().collect::<Vec<_>>(), [(2, 1)]);
    }

    #[test]
    fn what_may_be_hit_or_missed_is_not_compared_nor_what_is_beside_it() {
        let rows_of = |rows: [&str; 7]| seen(&rows);
        let input =
            rows_of(["........", "........", "...11111", "...11111", "...11111", "...11111", "...11111"]);
        let splats =
            rows_of(["5.......", ".......5", ".5......", "........", "........", "........", "........"]);
        let mut perhaps = depths(&input);
        for (at, row) in [(2, 0), (3, 3), (2, 5)] {
            perhaps.depths[row * 8 + at] = f64::INFINITY;
            perhaps.perhaps[row * 8 + at] = true;
        }
        let map = compare(&perhaps, &splats, 2.0);
        let expected = ["e|||    ", " |||||||", " e||||||", "  |||mm|", " ||||mm|", " |||mmm|", " |||||||"];
        assert_eq!(rows(&map), expected);
    }

    #[test]
    fn faults_have_their_colours() {
        let map =
            HoleMap { size: [2, 2], marks: vec![Mark::Missing, Mark::Extra, Mark::Same, Mark::Silhouette] };
        let picture = map.picture(&RgbImage::from_pixel(2, 2, Rgb([80, 80, 80])));
        let colors: Vec<[u8; 3]> = picture.pixels().map(|pixel| pixel.0).collect();
        assert_eq!(colors, [[225, 0, 0], [0, 60, 255], [187; 3], [187; 3]]);
    }
}
