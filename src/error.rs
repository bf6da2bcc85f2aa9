//! What can go wrong, sorted by who is to blame.
//!
//! Every message names the offending value and the place, and ends with what to do next.

use std::path::{Path, PathBuf};

/// The result of everything in this crate that can fail.
pub type Result<T> = std::result::Result<T, Error>;

/// An error, sorted by who can mend it.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The caller asked for something that makes no sense, such as a negative error budget.
    #[error("{0}")]
    Usage(String),
    /// An input file (mesh, cloud, polylines, camera) is broken or not supported.
    #[error("{}: {place}: {what}", path.display())]
    Input {
        /// The file.
        path: PathBuf,
        /// Where in it: a line, a byte offset, an element, or `file` for the whole.
        place: String,
        /// The fault and the remedy.
        what: String,
    },
    /// The input is sound but larger than the limits in force.
    #[error("{}: {what}", path.display())]
    Limits {
        /// The file.
        path: PathBuf,
        /// The limit, the value that passed it, and how to raise it.
        what: String,
    },
    /// A `.qsplat` file is broken, or of a version this reader does not know.
    #[error("not a sound .qsplat: {place}: {what}")]
    Format {
        /// The header field, chunk or byte offset.
        place: String,
        /// The fault and the remedy.
        what: String,
    },
    /// The file system refused.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's own error.
        source: std::io::Error,
    },
    /// The graphics device is missing or failed.
    #[error("graphics device: {0}")]
    Device(String),
    /// A promise of this program does not hold: a bug to report.
    #[error("internal error, please report it: {0}")]
    Internal(String),
}

impl Error {
    /// An [`Error::Input`] from anything printable.
    pub fn input(path: &Path, place: impl Into<String>, what: impl Into<String>) -> Self {
        Self::Input { path: path.to_owned(), place: place.into(), what: what.into() }
    }

    /// An [`Error::Format`] from anything printable.
    pub fn format(place: impl Into<String>, what: impl Into<String>) -> Self {
        Self::Format { place: place.into(), what: what.into() }
    }

    /// Wraps a system error with the file it happened on; for `map_err`.
    pub fn io(path: &Path) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self::Io { path, source }
    }
}
