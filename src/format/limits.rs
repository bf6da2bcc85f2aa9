//! What a reader is willing to allocate, decided before it does.

use std::path::PathBuf;

use crate::error::{Error, Result};

/// Limits of reading; each is checked before anything of that size is allocated.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Bytes of the file. Default `2^30`.
    pub file_bytes: u64,
    /// Splats; each takes about 180 bytes of memory. Default `2^22`.
    pub splats: u64,
    /// Clip curves; each takes about 60 bytes of memory. Default `2^22`.
    pub clips: u64,
    /// Pairs of clip partners; each takes about 400 bytes of memory. Default `2^20`.
    pub partners: u64,
    /// Bytes of all chunks after zstd. Default `2^28`.
    pub decoded_bytes: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            file_bytes: 1 << 30,
            splats: 1 << 22,
            clips: 1 << 22,
            partners: 1 << 20,
            decoded_bytes: 1 << 28,
        }
    }
}

impl Limits {
    /// Refuses a value above its limit.
    pub(super) fn check(&self, what: &str, value: u64, limit: u64) -> Result<()> {
        if value > limit {
            return Err(Error::Limits {
                path: PathBuf::from("the .qsplat"),
                what: format!(
                    "{what}: {value} is above the limit of {limit}; raise the limit if you trust the file"
                ),
            });
        }
        Ok(())
    }
}
