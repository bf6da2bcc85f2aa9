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
    format::write_file(path, &encode(picture)?)
}

/// The bytes of a picture as a PNG.
///
/// # Errors
/// [`Error::Internal`] if it cannot be coded, which no picture in memory causes.
pub fn encode<P>(picture: &ImageBuffer<P, Vec<P::Subpixel>>) -> Result<Vec<u8>>
where
    P: PixelWithColorType,
    [P::Subpixel]: EncodableLayout,
{
    let mut bytes = Cursor::new(Vec::new());
    let coded = picture.write_to(&mut bytes, ImageFormat::Png);
    coded.map_err(|error| Error::Internal(format!("PNG: {error}")))?;
    Ok(bytes.into_inner())
}
