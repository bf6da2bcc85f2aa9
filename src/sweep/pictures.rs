//! The pictures of a sweep, as PNGs.

use super::case::Pictures;

/// All pictures, in the order of the report.
#[derive(Clone, Debug, Default)]
pub(super) struct Album {
    pub(super) models: Vec<Shown>,
}

/// The pictures of one input and its cases.
#[derive(Clone, Debug, Default)]
pub(super) struct Shown {
    /// The input; `None` if it could not be read or drawn.
    pub(super) input: Option<Vec<u8>>,
    /// As many as cases; `None` where one failed.
    pub(super) cases: Vec<Option<Pictures>>,
}
