//! The container: GLB chunks, JSON, buffers.

use std::borrow::Cow;
use std::path::{Component, Path, PathBuf};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use gltf_json::root::Get;
use gltf_json::{Index, Root};

use super::super::source::{Source, read_file};
use crate::error::{Error, Result};

/// First bytes of a GLB, and the types of its chunks.
const MAGIC: &[u8] = b"glTF";
const JSON_CHUNK: &[u8] = b"JSON";
const BIN_CHUNK: &[u8] = b"BIN\0";

/// Required extensions that change nothing that is read, or that are read.
const EXTENSIONS: &[&str] = &["KHR_mesh_quantization", "KHR_texture_transform", "KHR_lights_punctual"];
const MATERIAL_EXTENSIONS: &str = "KHR_materials_";

/// The JSON and all buffers.
pub(super) struct Document<'a> {
    pub source: &'a Source<'a>,
    pub root: Root,
    buffers: Vec<Cow<'a, [u8]>>,
}

impl<'a> Document<'a> {
    pub fn read(source: &'a Source<'a>) -> Result<Self> {
        let (json, blob) =
            if source.bytes.starts_with(MAGIC) { chunks(source)? } else { (source.bytes.as_slice(), None) };
        let root: Root = gltf_json::deserialize::from_slice(json).map_err(|e| {
            let place = format!("JSON line {} column {}", e.line(), e.column());
            source.at(place, format!("{e}; it is no sound glTF 2 JSON, export the file again"))
        })?;
        if !root.asset.version.starts_with("2.") {
            let what = format!("is glTF {:?}, only version 2 is read; convert it", root.asset.version);
            return Err(source.at("asset.version", what));
        }
        let known = |name: &str| EXTENSIONS.contains(&name) || name.starts_with(MATERIAL_EXTENSIONS);
        if let Some(name) = root.extensions_required.iter().find(|name| !known(name)) {
            let what = format!("{name} is required and not read; export the file without it");
            return Err(source.at("extensionsRequired", what));
        }
        let mut document = Self { source, root, buffers: Vec::new() };
        document.load_buffers(blob)?;
        Ok(document)
    }

    fn load_buffers(&mut self, blob: Option<&'a [u8]>) -> Result<()> {
        let mut left = self.source.limits.file_bytes;
        for (n, buffer) in self.root.buffers.iter().enumerate() {
            let place = format!("buffers[{n}]");
            let bytes = match (&buffer.uri, blob) {
                (Some(uri), _) => Cow::Owned(self.load(uri, &place, left)?),
                (None, Some(blob)) if n == 0 => Cow::Borrowed(blob),
                (None, _) => {
                    let what = "has no uri, and the file no binary chunk for it; export it again";
                    return Err(self.source.at(place, what));
                }
            };
            let (claimed, found) = (buffer.byte_length.0, bytes.len() as u64);
            if claimed > found {
                let what = format!(
                    "claims {claimed} bytes and has {found}; it is cut short, copy or export it again"
                );
                return Err(self.source.at(place, what));
            }
            left = left.saturating_sub(found);
            self.buffers.push(bytes);
        }
        Ok(())
    }

    /// The bytes of a URI: data, or a file beside this one.
    pub fn load(&self, uri: &str, place: &str, limit: u64) -> Result<Vec<u8>> {
        let fault = |what: String| self.source.at(place, what);
        if let Some(data) = uri.strip_prefix("data:") {
            let encoded = data.split_once(";base64,").map(|(_, encoded)| encoded);
            let bytes = encoded.and_then(|encoded| STANDARD.decode(encoded).ok());
            return bytes
                .ok_or_else(|| fault("its data URI is no sound base64; export the file again".into()));
        }
        let name = decode_percent(uri);
        let Some(path) = beside(self.source.path, &name) else {
            return Err(fault(format!("{name:?} is no file relative to this one; put the file beside it")));
        };
        if !path.is_file() {
            return Err(fault(format!("the file {name:?} is missing; put it beside this one or use GLB")));
        }
        read_file(&path, limit).map_err(|error| match error {
            Error::Io { source, .. } => {
                fault(format!("the file {name:?} cannot be read: {source}; check its permissions"))
            }
            other => other,
        })
    }

    /// Bytes of the file and all its buffers.
    pub fn bytes(&self) -> u64 {
        let buffers: u64 = self.buffers.iter().map(|buffer| buffer.len() as u64).sum();
        buffers + self.source.bytes.len() as u64
    }

    /// An object of the document by index.
    pub fn get<T>(&self, index: Index<T>, place: &str) -> Result<&T>
    where
        Root: Get<T>,
    {
        self.root.get(index).ok_or_else(|| {
            let what =
                format!("index {} names nothing in the document; export the file again", index.value());
            self.source.at(place, what)
        })
    }

    /// The bytes of a buffer view and the stride that it asks for.
    pub fn view(&self, index: Index<gltf_json::buffer::View>, place: &str) -> Result<(&[u8], Option<usize>)> {
        let view = self.get(index, place)?;
        let place = format!("bufferViews[{}]", index.value());
        let Some(buffer) = self.buffers.get(view.buffer.value()) else {
            let what = format!("buffer {} does not exist; export the file again", view.buffer.value());
            return Err(self.source.at(place, what));
        };
        let (offset, length) = (view.byte_offset.unwrap_or_default().0, view.byte_length.0);
        let Some(bytes) = span(buffer, offset, length) else {
            let what = format!(
                "bytes {offset} to {} are not all in buffer {} of {} bytes; export the file again",
                offset.saturating_add(length),
                view.buffer.value(),
                buffer.len()
            );
            return Err(self.source.at(place, what));
        };
        Ok((bytes, view.byte_stride.map(|stride| stride.0)))
    }
}

/// `length` bytes from `offset` on, where they all exist.
pub(super) fn span(bytes: &[u8], offset: u64, length: u64) -> Option<&[u8]> {
    let start = usize::try_from(offset).ok()?;
    let end = usize::try_from(offset.checked_add(length)?).ok()?;
    bytes.get(start..end)
}

/// The JSON and binary chunks of a GLB: 12 bytes of header, then length, type and data of each.
fn chunks<'a>(source: &'a Source) -> Result<(&'a [u8], Option<&'a [u8]>)> {
    let bytes = source.bytes.as_slice();
    let word =
        |at: usize| bytes.get(at..).and_then(|rest| rest.first_chunk()).map(|&w| u32::from_le_bytes(w));
    let cut = |at: usize, what: String| {
        source.at(
            format!("byte {at}"),
            format!("{what}; the file is cut short or damaged, copy or export it again"),
        )
    };
    let (Some(version), Some(length)) = (word(4), word(8)) else {
        return Err(cut(bytes.len(), "the GLB header needs 12 bytes".into()));
    };
    if version != 2 {
        return Err(source.at("byte 4", format!("is GLB version {version}, only 2 is read; convert it")));
    }
    let Some(bytes) = span(bytes, 0, u64::from(length)) else {
        return Err(cut(8, format!("the GLB claims {length} bytes and has {}", bytes.len())));
    };
    let (mut json, mut blob, mut at) = (None, None, 12);
    while let Some(length) = word(at).filter(|_| at < bytes.len()) {
        let data = bytes.get(at + 4..at + 8).zip(span(bytes, at as u64 + 8, u64::from(length)));
        let Some((kind, data)) = data else {
            return Err(cut(at, format!("a chunk claims {length} bytes, more than are left")));
        };
        match kind {
            JSON_CHUNK if json.is_none() => json = Some(data),
            BIN_CHUNK if blob.is_none() => blob = Some(data),
            // Chunks of other types are to be ignored (glTF 2.0, 4.4.3.1).
            _ => {}
        }
        at += 8 + data.len();
    }
    let json = json.ok_or_else(|| cut(12, "there is no JSON chunk".into()))?;
    Ok((json, blob))
}

/// The file a relative URI names; `None` for an absolute path or another scheme.
fn beside(path: &Path, name: &str) -> Option<PathBuf> {
    let relative = Path::new(name);
    let plain = |part: Component| !matches!(part, Component::RootDir | Component::Prefix(_));
    if name.contains("://") || !relative.components().all(plain) {
        return None;
    }
    Some(path.parent().unwrap_or(Path::new("")).join(relative))
}

/// Undoes `%20` and the like (RFC 3986, 2.1); anything else stays as it is.
fn decode_percent(uri: &str) -> String {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, tail @ ..] = rest {
        let digits = tail.get(..2).filter(|digits| digits.iter().all(u8::is_ascii_hexdigit));
        let code = digits.and_then(|digits| std::str::from_utf8(digits).ok());
        match code.and_then(|code| u8::from_str_radix(code, 16).ok()) {
            Some(byte) if *first == b'%' => {
                bytes.push(byte);
                rest = &tail[2..];
            }
            _ => {
                bytes.push(*first);
                rest = tail;
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uris_name_files_beside() {
        assert_eq!(decode_percent("a%20b%2fc%zz%"), "a b/c%zz%");
        let model = Path::new("models/a.gltf");
        assert_eq!(beside(model, "b/c.bin"), Some(PathBuf::from("models/b/c.bin")));
        assert_eq!(beside(model, "/etc/passwd"), None);
        assert_eq!(beside(model, "http://host/c.bin"), None);
    }
}
