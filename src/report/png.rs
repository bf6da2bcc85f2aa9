//! Pictures as PNG files.

use std::io::Cursor;
use std::path::Path;

use image::{EncodableLayout, ImageBuffer, ImageFormat, PixelWithColorType};

use crate::error::{Error, Result};
use crate::format;

/// Writes a picture as a PNG, whole or not at all. The same picture gives the same bytes.
///
/// # Errors
/// [`Error::Io`].
pub fn write<P>(path: &Path, picture: &ImageBuffer<P, Vec<P::Subpixel>>) -> Result<()>
where
    P: PixelWithColorType,
    [P::Subpixel]: EncodableLayout,
{
    let mut bytes = Cursor::new(Vec::new());
    picture
        .write_to(&mut bytes, ImageFormat::Png)
        .map_err(|error| Error::Internal(format!("{}: {error}", path.display())))?;
    format::write_file(path, bytes.get_ref())
}
