//! Files on disk: read within limits, written whole or not at all.

use std::fs::File;
use std::io::{Read, Write};
use std::path::Path;

use super::limits::Limits;
use super::read::decode;
use crate::error::{Error, Result};
use crate::model::asset::Asset;

/// Reads a `.qsplat` file.
///
/// # Errors
/// [`Error::Io`]; else as [`decode`], with the file's name in the place.
pub fn read_file(path: &Path, limits: &Limits) -> Result<Asset> {
    decode(&read_bytes(path, limits)?, limits).map_err(|error| named(error, path))
}

/// The bytes of a file, no more than the limits allow.
///
/// # Errors
/// [`Error::Io`], [`Error::Limits`].
pub fn read_bytes(path: &Path, limits: &Limits) -> Result<Vec<u8>> {
    let file = File::open(path).map_err(Error::io(path))?;
    let mut bytes = Vec::new();
    file.take(limits.file_bytes.saturating_add(1)).read_to_end(&mut bytes).map_err(Error::io(path))?;
    limits.check("file bytes", bytes.len() as u64, limits.file_bytes).map_err(|error| named(error, path))?;
    Ok(bytes)
}

/// Writes a file by way of a temporary one beside it, which is renamed when it is whole.
///
/// # Errors
/// [`Error::Io`]; then the target is as it was before, and nothing half-written stays.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<()> {
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let mut builder = tempfile::Builder::new();
    builder.prefix(".qsplat-");
    // A temporary file is private by default; the finished one gets what the umask leaves.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = builder.tempfile_in(folder).map_err(Error::io(path))?;
    file.write_all(bytes).map_err(Error::io(path))?;
    file.as_file().sync_all().map_err(Error::io(path))?;
    file.persist(path).map_err(|error| Error::io(path)(error.error))?;
    Ok(())
}

/// Puts the file's name into an error about its bytes.
fn named(error: Error, path: &Path) -> Error {
    match error {
        Error::Format { place, what } => {
            Error::Format { place: format!("{}: {place}", path.display()), what }
        }
        Error::Limits { what, .. } => Error::Limits { path: path.to_owned(), what },
        other => other,
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_whole_or_absent_and_nothing_stays_beside_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.qsplat");
        write_file(&path, b"one").unwrap();
        write_file(&path, b"two").unwrap();
        assert_eq!(read_bytes(&path, &Limits::default()).unwrap(), b"two");
        // A folder cannot be replaced by a file: the rename fails after the writing.
        let taken = folder.path().join("taken");
        std::fs::create_dir(&taken).unwrap();
        std::fs::write(taken.join("x"), b"").unwrap();
        assert!(matches!(write_file(&taken, b"three"), Err(Error::Io { .. })));
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
    }

    #[test]
    fn errors_name_the_file_and_limits_hold_before_reading() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("b.qsplat");
        write_file(&path, &[0; 300]).unwrap();
        let message = read_file(&path, &Limits::default()).unwrap_err().to_string();
        assert!(message.contains("b.qsplat") && message.contains("magic"), "{message}");
        let limits = Limits { file_bytes: 299, ..Limits::default() };
        assert!(matches!(read_file(&path, &limits), Err(Error::Limits { .. })));
    }
}
