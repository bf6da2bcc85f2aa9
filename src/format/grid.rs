//! The grids of the file: what each whole number stands for.
//!
//! Every length is counted in error budgets `E`, so a file's grids follow from its
//! `max_error` and seven small numbers, the [`Steps`], which the header holds. Every formula
//! here uses only `+ - * /` and comparison on 64-bit floats, in the order written, so that all
//! decoders agree in the last bit.

use crate::error::{Error, Result};

/// The fineness of the grids, as the header holds it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Steps {
    /// Edge of a position cell, in 1/16 `E`.
    pub cell: u8,
    /// Bits below the cell along the dominant axis: the height step is `cell / 2^height`.
    pub height: u8,
    /// The tangential step is at most about `2^-slide` of the smaller radius.
    pub slide: u8,
    /// Lattice step of the normal times the larger radius, in 1/256 `E`.
    pub tilt: u8,
    /// Step of the two sagittas, in 1/256 `E`.
    pub bend: u8,
    /// Largest height moved by rounding the turn about the normal, in 1/256 `E`.
    pub spin: u8,
    /// Step of a clip curve's control point in the plane, in 1/1024 `E`.
    pub clip: u8,
}

/// The steps this version writes: near the fewest bytes of whole bakes at the default budget
/// (smooth, scanned), where splats are judged after rounding, so that coarser steps cost radius.
pub const STEPS: Steps = Steps { cell: 40, height: 2, slide: 5, tilt: 80, bend: 180, spin: 80, clip: 68 };

/// Largest `height` and `slide` a header may state.
pub const MAX_SHIFT: u8 = 12;

/// Positions are kept as whole cells from `-CELL_BIAS` to `CELL_BIAS - 1` on each axis.
pub const CELL_BIAS: i64 = 1 << 27;

/// Steps of a radius between two powers of two.
const RADIUS_MANTISSA: u16 = 32;

/// Codes of radii are below this; the largest is almost `2^28 E`.
pub const RADIUS_CODES: u16 = 1024;

/// The smallest radius is `2^RADIUS_LEAST E`.
const RADIUS_LEAST: i32 = -4;

/// The finest fineness: all steps but the clip's are divided by `2^fineness`.
pub const MAX_FINENESS: u8 = 16;

/// `|P2 - (P1+P3)/2|` is at most this many clip steps along each axis.
pub const CONTROL_LIMIT: u64 = 1 << 40;

/// Rounding the turn moves the rim by at most about `1 / (2 * ASPECT)` of a radius.
const ASPECT: f64 = 32.0;

/// Half a turn's worth of steps over the error of half a step: `pi/2`, rounded up.
const HALF_TURN: f64 = 1.570_796_4;

/// `pi * sqrt(2)`, rounded up: border steps as fine as half the control grid's diagonal.
const BORDER: f64 = 4.442_883;

/// A radius code.
pub type Size = u16;

/// The grids of one file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grids {
    /// The error budget `E`, model units.
    pub budget: f64,
    /// The fineness.
    pub steps: Steps,
    /// [`GUESS_BEND`] and [`GUESS_SPIN`]: what is guessed from the nearest splat.
    pub guesses: u8,
}

/// Sagittas are guessed from the curvatures of the nearest splat: pays on smooth surfaces.
pub const GUESS_BEND: u8 = 1;

/// Turns are guessed from the frame of the nearest splat: pays where curvature has a direction.
pub const GUESS_SPIN: u8 = 2;

impl Steps {
    /// Refuses steps that a header must not state.
    ///
    /// # Errors
    /// [`Error::Format`] for a zero step or a shift above [`MAX_SHIFT`].
    pub fn check(&self) -> Result<()> {
        let positive = [self.cell, self.tilt, self.bend, self.spin, self.clip];
        if positive.contains(&0) || self.height > MAX_SHIFT || self.slide > MAX_SHIFT {
            return Err(Error::format(
                "header, steps",
                format!("{self:?} is out of range; rewrite the file"),
            ));
        }
        Ok(())
    }
}

/// `2^n` for small `n`.
fn power(n: i32) -> f64 {
    libm::ldexp(1.0, n)
}

/// A radius in units of `E`, exactly.
#[must_use]
pub fn radius(size: Size) -> f64 {
    let mantissa = RADIUS_MANTISSA + size % RADIUS_MANTISSA;
    f64::from(mantissa) * power(i32::from(size / RADIUS_MANTISSA) + RADIUS_LEAST - 5)
}

/// Slack for radii that come back from the file a few roundings above their grid value.
const RADIUS_ROUNDING: f64 = 1e-12;

/// The least code whose radius is at least `radius` (in units of `E`); `None` above the range.
#[must_use]
pub fn size_above(wanted: f64) -> Option<Size> {
    let wanted = wanted * (1.0 - RADIUS_ROUNDING);
    let (mut low, mut high) = (0, RADIUS_CODES);
    while low < high {
        let middle = (low + high) / 2;
        if radius(middle) < wanted {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    (low < RADIUS_CODES).then_some(low)
}

impl Grids {
    /// Edge of a cell, model units.
    #[must_use]
    pub fn cell(&self) -> f64 {
        self.budget * (f64::from(self.steps.cell) / 16.0)
    }

    /// Bits below the cell of the coordinate along the splat's axis.
    #[must_use]
    pub fn height_bits(&self, fineness: u8) -> u32 {
        u32::from(self.steps.height) + u32::from(fineness)
    }

    /// Bits below the cell of the two other coordinates.
    #[must_use]
    pub fn slide_bits(&self, small: Size, fineness: u8) -> u32 {
        let exponent = i32::from(small / RADIUS_MANTISSA) + RADIUS_LEAST;
        let wanted = i32::from(self.steps.slide) - exponent + i32::from(fineness);
        wanted.clamp(0, self.height_bits(fineness) as i32) as u32
    }

    /// Steps of the normal's lattice for a splat with this larger radius.
    #[must_use]
    pub fn normal_steps(&self, large: Size, fineness: u8) -> u64 {
        let steps = radius(large) * 256.0 * power(i32::from(fineness)) / f64::from(self.steps.tilt);
        steps.ceil().max(2.0) as u64
    }

    /// The sagitta step, in units of `E`.
    #[must_use]
    pub fn bend(&self, fineness: u8) -> f64 {
        f64::from(self.steps.bend) / 256.0 * power(-i32::from(fineness))
    }

    /// Bits of the turn of `i` about `k`, over half a turn.
    ///
    /// None for a splat that looks the same however it is turned.
    #[must_use]
    pub fn spin_bits(&self, sizes: [Size; 2], bend: [i64; 2], fineness: u8) -> u32 {
        if sizes[0] == sizes[1] && bend[0] == bend[1] {
            return 0;
        }
        let ratio = radius(sizes[0]) / radius(sizes[1]);
        let step = self.bend(fineness);
        let twist = (bend[0] as f64 * step / ratio - bend[1] as f64 * step * ratio).abs();
        let by_height = twist * 256.0 / f64::from(self.steps.spin);
        let by_shape = (ratio - 1.0 / ratio) * ASPECT;
        let wanted = HALF_TURN * by_height.max(by_shape) * power(i32::from(fineness));
        (1..=40).find(|&bits| power(bits) >= wanted).unwrap_or(40) as u32
    }

    /// The clip step, model units.
    #[must_use]
    pub fn clip(&self) -> f64 {
        self.budget * (f64::from(self.steps.clip) / 1024.0)
    }

    /// Steps of a border point around the ellipse with this larger radius: a multiple of the coarsest
    /// [`GRAINS`].
    #[must_use]
    pub fn border_steps(&self, large: Size) -> u64 {
        let coarsest = unit(0);
        let finest = radius(large) * BORDER * 1024.0 / f64::from(self.steps.clip);
        (finest / coarsest as f64).ceil().max(1.0) as u64 * coarsest
    }
}

/// Clip curves are written in steps of one size of so many, each half of the one before.
pub const GRAINS: u8 = 5;

/// Clip steps in a step of a grain; the finest has one.
#[must_use]
pub fn unit(grain: u8) -> u64 {
    1 << (GRAINS - 1 - grain)
}

/// Steps of `rho` for a control point this many clip steps from the chord's middle.
#[must_use]
pub fn rho_steps(control: [i64; 2]) -> u64 {
    control[0].unsigned_abs() + control[1].unsigned_abs()
}
