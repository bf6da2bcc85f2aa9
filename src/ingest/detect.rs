//! Which format a file has: by content, then by extension.

use super::source::Source;
use super::text;
use crate::error::{Error, Result};

/// A format that is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    Ply,
    Obj,
    Off,
    Gltf,
}

/// Formats that are known by their first bytes and not read.
const SIGNATURES: &[(&[u8], &str)] = &[
    (b"LASF", "a LAS or LAZ point cloud"),
    (b"ASTM-E57", "an E57 point cloud"),
    (b"# .PCD", "a PCD point cloud"),
    (b"VERSION .7", "a PCD point cloud"),
    (b"VERSION 0.7", "a PCD point cloud"),
    (b"PK\x03\x04", "a ZIP archive, perhaps 3MF or USDZ"),
    (b"\x1f\x8b", "compressed with gzip"),
    (b"\x28\xb5\x2f\xfd", "compressed with zstd"),
    (b"\x89PNG", "a PNG image"),
    (b"\xff\xd8\xff", "a JPEG image"),
    (b"Kaydara FBX", "an FBX scene"),
    (b"; FBX", "an FBX scene"),
    (b"BLENDER", "a Blender scene"),
    (b"PXR-USDC", "a USD scene"),
    (b"#usda", "a USD scene"),
    (b"DRACO", "a Draco mesh"),
    (b"# vtk DataFile", "a VTK file"),
    (b"#VRML", "a VRML scene"),
    (b"ISO-10303-21", "a STEP model"),
    (b"<?xml", "an XML file, perhaps COLLADA, X3D or VTK"),
    (b"<COLLADA", "a COLLADA scene"),
    (b"glTF\x01", "glTF 1"),
];

/// Extensions of formats that are known and not read, for content that says nothing.
const EXTENSIONS: &[(&[&str], &str)] = &[
    (&["stl"], "an STL mesh"),
    (&["pcd"], "a PCD point cloud"),
    (&["las", "laz"], "a LAS or LAZ point cloud"),
    (&["e57"], "an E57 point cloud"),
    (&["3mf"], "a 3MF model"),
    (&["xyz", "txt", "csv", "pts", "asc"], "an XYZ text cloud"),
    (&["fbx"], "an FBX scene"),
    (&["dae"], "a COLLADA scene"),
    (&["step", "stp", "iges", "igs"], "a CAD model"),
];

/// Words that begin a record of an OBJ file.
const OBJ_RECORDS: &[&[u8]] =
    &[b"v", b"vn", b"vt", b"vp", b"f", b"l", b"p", b"o", b"g", b"s", b"mtllib", b"usemtl"];

/// Lines at the front of a text in which its format must show.
const FRONT_LINES: usize = 1000;

/// Bytes of the fixed part of a binary STL, and of each of its triangles.
const STL_HEADER: usize = 84;
const STL_TRIANGLE: usize = 50;

/// Tells the format.
///
/// # Errors
/// [`Error::Input`] for an empty file, and for a format that is not read, by name.
pub(super) fn format(source: &Source) -> Result<Format> {
    let bytes = source.bytes.as_slice();
    if bytes.is_empty() {
        return Err(source.whole("is empty; export or copy it again"));
    }
    if let Some((_, name)) = SIGNATURES.iter().find(|(magic, _)| bytes.starts_with(magic)) {
        return Err(not_read(source, name));
    }
    let extension =
        source.path.extension().map(|end| end.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    if let Some(format) = by_content(source, &extension)? {
        return Ok(format);
    }
    match extension.as_str() {
        "ply" => Ok(Format::Ply),
        "obj" => Ok(Format::Obj),
        "off" => Ok(Format::Off),
        "gltf" | "glb" => Ok(Format::Gltf),
        _ => Err(unknown(source, &extension)),
    }
}

fn by_content(source: &Source, extension: &str) -> Result<Option<Format>> {
    let bytes = source.bytes.as_slice();
    if let [b'p', b'l', b'y', b'\r' | b'\n' | b' ' | b'\t', ..] = bytes {
        return Ok(Some(Format::Ply));
    }
    if bytes.starts_with(b"glTF") {
        return Ok(Some(Format::Gltf));
    }
    if is_stl(bytes) {
        return Err(not_read(source, "an STL mesh"));
    }
    let first = bytes.iter().find(|byte| !byte.is_ascii_whitespace());
    if first == Some(&b'{') {
        return Ok(Some(Format::Gltf));
    }
    let mut lines = text::lines(bytes, 0).take(FRONT_LINES).map(|line| line.bytes);
    let Some(line) = lines.find(|line| text::tokens(line).next().is_some_and(|word| word[0] != b'#')) else {
        return Ok(None);
    };
    let word = text::tokens(line).next().unwrap_or_default();
    if word.ends_with(b"OFF") && word.len() <= b"STCN4nOFF".len() {
        return Ok(Some(Format::Off));
    }
    if OBJ_RECORDS.contains(&word) {
        return Ok(Some(Format::Obj));
    }
    // An OFF file may leave its first word out, and begins with three numbers then.
    if extension != "off" && is_row_of_numbers(line) {
        return Err(not_read(source, "an XYZ text cloud"));
    }
    Ok(None)
}

/// ASCII STL by its words, binary STL by the size that its count asks for.
fn is_stl(bytes: &[u8]) -> bool {
    let count = bytes.get(STL_HEADER - 4..STL_HEADER).and_then(|field| field.first_chunk());
    let size = count.map(|&count| u32::from_le_bytes(count) as usize);
    let binary = size.is_some_and(|count| {
        count.checked_mul(STL_TRIANGLE).and_then(|size| size.checked_add(STL_HEADER)) == Some(bytes.len())
    });
    binary || (bytes.starts_with(b"solid") && bytes.windows(5).take(1 << 16).any(|word| word == b"facet"))
}

fn is_row_of_numbers(line: &[u8]) -> bool {
    let mut count = 0;
    let fields = line.split(|byte| byte.is_ascii_whitespace() || matches!(byte, b',' | b';'));
    let numeric = fields.filter(|field| !field.is_empty()).all(|field| {
        count += 1;
        text::number(field).is_some()
    });
    numeric && count >= 3
}

fn unknown(source: &Source, extension: &str) -> Error {
    match EXTENSIONS.iter().find(|(ends, _)| ends.contains(&extension)) {
        Some((_, name)) => not_read(source, name),
        None => not_read(source, "of no known format"),
    }
}

fn not_read(source: &Source, name: &str) -> Error {
    source.whole(format!("is {name}, which qsplat does not read; convert it to PLY, OBJ or glTF"))
}
