//! The decoder under torture: whatever the bytes, it gives an error or a sound asset, without
//! a panic and without allocating more than the limits allow.

#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout)]

use std::path::Path;

use qsplat::Error;
use qsplat::format::{Limits, decode, inspect};
use qsplat::model::asset::Asset;

/// Fields of the header in their order; those of `form` bits that are clear are empty.
const FIELDS: [&str; 13] = [
    "start",
    "required",
    "optional",
    "form",
    "splats",
    "straight",
    "curved",
    "steps",
    "exponent",
    "origin",
    "diagonal",
    "max error",
    "fit",
];
/// The chunks that have numbers, from 1.
const NUMBERED: [&[u8; 4]; 3] = [b"SPLT", b"COLR", b"PART"];
/// Form: the steps are stated.
const OWN_STEPS: u8 = 4;
/// Form: the origin has 64 bits.
const FREE_ORIGIN: u8 = 8;
/// Form: lengths have 64 bits.
const LONG_LENGTHS: u8 = 16;

fn vector(name: &str) -> Vec<u8> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("fixtures/vectors/{name}.qsplat"));
    std::fs::read(path).unwrap()
}

/// A whole number, seven bits a byte.
fn varint(mut value: u64) -> Vec<u8> {
    let mut bytes = Vec::new();
    while value > 0x7f {
        bytes.push(value as u8 | 0x80);
        value >>= 7;
    }
    bytes.push(value as u8);
    bytes
}

/// Bytes with their checksum behind.
fn sealed(bytes: &[u8]) -> Vec<u8> {
    [bytes, &crc32fast::hash(bytes).to_le_bytes()].concat()
}

/// Takes bytes off the front.
fn take<'a>(rest: &mut &'a [u8], count: usize) -> &'a [u8] {
    let (first, after) = rest.split_at(count);
    *rest = after;
    first
}

/// Takes a varint off the front: its bytes, and what they say.
fn take_varint<'a>(rest: &mut &'a [u8]) -> (&'a [u8], u64) {
    let count = 1 + rest.iter().take_while(|byte| **byte > 0x7f).count();
    let bytes = take(rest, count);
    let bits = bytes.iter().zip((0..).step_by(7));
    (bytes, bits.fold(0, |value, (byte, shift)| value | u64::from(byte & 0x7f) << shift))
}

/// A chunk: id, flags, raw length, bytes.
type Chunk = ([u8; 4], u8, u32, Vec<u8>);

/// A file taken apart, so that it can be put together wrongly.
#[derive(Clone)]
struct Parts {
    /// The bytes of each of [`FIELDS`].
    header: [Vec<u8>; 13],
    chunks: Vec<Chunk>,
}

impl Parts {
    fn of(bytes: &[u8]) -> Self {
        let mut rest = &bytes[..bytes.len() - 4];
        let start = take(&mut rest, 5);
        let (required, optional) = (take_varint(&mut rest).0, take_varint(&mut rest).0);
        let form = take(&mut rest, 1);
        let on = |bit: u8| form[0] & bit != 0;
        let counts = [(); 3].map(|()| take_varint(&mut rest).0);
        let steps = take(&mut rest, if on(OWN_STEPS) { 7 } else { 0 });
        let exponent = take_varint(&mut rest).0;
        let origin = if on(FREE_ORIGIN) {
            take(&mut rest, 24).to_vec()
        } else {
            [(); 3].map(|()| take_varint(&mut rest).0).concat()
        };
        let length = if on(LONG_LENGTHS) { 8 } else { 4 };
        let (diagonal, max_error) = (take(&mut rest, length), take(&mut rest, length));
        let fit = [(); 3].map(|()| take_varint(&mut rest).0).concat();
        let [splats, straight, curved] = counts;
        let header = [
            start, required, optional, form, splats, straight, curved, steps, exponent, &origin, diagonal,
            max_error, &fit,
        ];
        let mut parts = Self { header: header.map(<[u8]>::to_vec), chunks: Vec::new() };
        while !rest.is_empty() {
            let tag = take(&mut rest, 1)[0];
            let id = NUMBERED[usize::from(tag >> 2) - 1];
            let raw = if tag & 2 != 0 { Some(take_varint(&mut rest).1) } else { None };
            let coded = take_varint(&mut rest).1;
            let bytes = take(&mut rest, coded as usize).to_vec();
            parts.chunks.push((*id, tag & 3, raw.unwrap_or(coded) as u32, bytes));
        }
        parts
    }

    /// Whole again, with lengths and a checksum that fit.
    fn whole(&self) -> Vec<u8> {
        let mut out = self.header.concat();
        for (id, flags, raw, bytes) in &self.chunks {
            match NUMBERED.iter().zip(1..).find(|(known, _)| **known == id) {
                Some((_, number)) => out.push(flags | number << 2),
                None => out.extend([&[*flags], id.as_slice()].concat()),
            }
            if flags & 2 != 0 {
                out.extend(varint(u64::from(*raw)));
            }
            out.extend(varint(bytes.len() as u64));
            out.extend(bytes);
        }
        sealed(&out)
    }

    fn field(&mut self, name: &str) -> &mut Vec<u8> {
        &mut self.header[FIELDS.iter().position(|field| *field == name).unwrap()]
    }

    /// The same with one field of the header put otherwise.
    fn with(&self, name: &str, bytes: &[u8]) -> Self {
        let mut other = self.clone();
        *other.field(name) = bytes.to_vec();
        other
    }

    /// The same with a bit of the form set.
    fn formed(&self, bit: u8) -> Self {
        let mut other = self.clone();
        other.field("form")[0] |= bit;
        other
    }

    fn chunk(&mut self, id: &[u8; 4]) -> &mut Chunk {
        self.chunks.iter_mut().find(|chunk| chunk.0 == *id).unwrap()
    }

    /// The decoded bytes of a chunk, to be changed; stored without zstd.
    fn bare(&mut self, id: &[u8; 4]) -> &mut Vec<u8> {
        let chunk = self.chunk(id);
        if chunk.1 & 2 != 0 {
            let frame = [&[0x28, 0xb5, 0x2f, 0xfd], chunk.3.as_slice()].concat();
            chunk.3 = zstd::bulk::decompress(&frame, chunk.2 as usize).unwrap();
            chunk.1 &= !2;
        }
        &mut chunk.3
    }
}

/// An error, or an asset in which every number is sound.
fn sound(bytes: &[u8], limits: &Limits) -> Result<Asset, Error> {
    let _ = inspect(bytes, limits);
    let asset = decode(bytes, limits)?;
    assert!(asset.splats.len() as u64 <= limits.splats);
    assert!(asset.diagonal > 0.0 && asset.max_error > 0.0 && asset.frame.origin.is_finite());
    for splat in &asset.splats {
        assert!(splat.center.is_finite() && splat.curvature.is_finite());
        assert!(splat.radii.min_element() > 0.0 && splat.radii.is_finite());
        let off = splat.axes.transpose() * splat.axes - glam::DMat3::IDENTITY;
        assert!(off.to_cols_array().iter().all(|d| d.abs() < 1e-14));
        for clip in &splat.clips {
            assert!(clip.p2.is_finite() && (0.0..=1.0).contains(&clip.rho));
            for alpha in [clip.alpha1, clip.alpha3] {
                assert!((0.0..std::f64::consts::TAU).contains(&alpha));
            }
        }
    }
    for (n, splat) in asset.splats.iter().enumerate() {
        for partner in splat.partners.iter().flatten() {
            assert!((partner.splat as usize) < asset.splats.len() && partner.splat as usize != n);
        }
    }
    Ok(asset)
}

fn refused(bytes: &[u8]) -> String {
    match sound(bytes, &Limits::default()) {
        Err(error @ (Error::Format { .. } | Error::Limits { .. })) => error.to_string(),
        other => panic!("not refused: {other:?}"),
    }
}

#[test]
fn the_pieces_fit_together_again() {
    for name in ["empty", "smooth", "mixed", "steep", "worked-example", "partnered"] {
        let bytes = vector(name);
        assert_eq!(Parts::of(&bytes).whole(), bytes);
        sound(&bytes, &Limits::default()).unwrap();
    }
}

#[test]
fn every_prefix_and_every_tail_is_refused() {
    for name in ["mixed", "smooth", "empty", "partnered"] {
        let bytes = vector(name);
        for end in 0..bytes.len() {
            refused(&bytes[..end]);
        }
        for tail in [&[0_u8][..], &[0; 17], &bytes] {
            refused(&[&bytes, tail].concat());
        }
    }
}

#[test]
fn every_prefix_is_refused_though_its_checksum_fits() {
    for name in ["mixed", "empty", "partnered"] {
        let bytes = vector(name);
        let body = &bytes[..bytes.len() - 4];
        for end in 0..body.len() {
            refused(&sealed(&body[..end]));
        }
        refused(&sealed(&[body, &[0]].concat()));
    }
}

#[test]
fn every_changed_byte_is_refused() {
    let bytes = vector("mixed");
    for at in 0..bytes.len() {
        for mask in [1, 0x80, 0xff] {
            let mut broken = bytes.clone();
            broken[at] ^= mask;
            refused(&broken);
        }
    }
}

#[test]
fn header_fields_at_their_limits() {
    let parts = Parts::of(&vector("mixed"));
    let known = sound(&parts.whole(), &Limits::default()).unwrap();
    let mut bad = Vec::new();
    for bit in 0..32 {
        let required = u64::from(parts.clone().field("required")[0]);
        bad.push(parts.with("required", &varint(required ^ (1 << bit))));
    }
    for bit in [32, 64, 128] {
        bad.push(parts.formed(bit));
    }
    for name in ["splats", "straight", "curved"] {
        let count = take_varint(&mut parts.clone().field(name).as_slice()).1;
        for wrong in [0, count - 1, count + 1, 1 << 22, (1 << 22) + 1, u64::from(u32::MAX), 1 << 32] {
            bad.push(parts.with(name, &varint(wrong)));
        }
    }
    for wrong in [2001_u64, 2002, u64::from(u32::MAX) - 1, u64::from(u32::MAX), 1 << 32] {
        bad.push(parts.with("exponent", &varint(wrong)));
    }
    bad.push(parts.with("fit", &[varint(1 << 32), varint(1), varint(1)].concat()));
    for field in ["required", "splats", "exponent", "fit"] {
        for wrong in [&[0x80, 0][..], &[0x80; 5], &[0xff; 6]] {
            bad.push(parts.with(field, wrong));
        }
    }
    let stated = parts.formed(OWN_STEPS);
    let steps = [40, 2, 5, 80, 180, 80, 68];
    for (at, wrong) in [(0, 0), (1, 13), (2, 13), (3, 0), (4, 0), (5, 0), (6, 0)] {
        let mut steps = steps;
        steps[at] = wrong;
        bad.push(stated.with("steps", &steps));
    }
    for bad in bad {
        refused(&bad.whole());
    }
    // Features that may be ignored, and steps that are those of the version, change nothing.
    let bits = u64::from(parts.clone().field("optional")[0]) | 1 << 31;
    for same in [parts.with("optional", &varint(bits)), stated.with("steps", &steps)] {
        assert_eq!(sound(&same.whole(), &Limits::default()).unwrap(), known);
    }
}

#[test]
fn numbers_that_no_header_may_state() {
    let parts = Parts::of(&vector("mixed"));
    let origin = |x: f64| [x, 0.0, 0.0].map(f64::to_le_bytes).concat();
    assert!(
        sound(&parts.formed(FREE_ORIGIN).with("origin", &origin(0.1)).whole(), &Limits::default()).is_ok()
    );
    for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        refused(&parts.formed(FREE_ORIGIN).with("origin", &origin(x)).whole());
    }
    let none = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0, 0.0, 1e-300, 1e300];
    for (name, more) in [("diagonal", [1e-19, 1e19]), ("max error", [1e9, 1e-8])] {
        for x in none.into_iter().chain(more) {
            refused(&parts.with(name, &x.to_le_bytes()).whole());
        }
    }
    let mut short = Parts::of(&vector("worked-example"));
    assert_eq!(short.field("form")[0] & LONG_LENGTHS, 0);
    for x in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, 0.0, f32::MAX, f32::MIN_POSITIVE] {
        for name in ["diagonal", "max error"] {
            refused(&short.with(name, &x.to_le_bytes()).whole());
        }
    }
}

#[test]
fn other_versions_are_refused_with_what_helps() {
    let parts = Parts::of(&vector("mixed"));
    for (version, words) in
        [(0, "bake the file anew"), (2, "bake the file anew"), (4, "update it"), (255, "update it")]
    {
        let other = parts.with("start", &[0x89, b'Q', b'S', b'P', version]);
        assert!(refused(&other.whole()).contains(words), "{version}");
    }
    // Versions 1 and 2 began otherwise.
    for version in [1, 2] {
        let message = refused(&[b"\x89QSP\r\n\x1a\n".as_slice(), &[version], &[0; 200]].concat());
        assert!(message.contains("1 or 2") && message.contains("bake the file anew"), "{message}");
    }
}

#[test]
fn chunks_that_are_unknown_missing_doubled_or_of_another_length() {
    let parts = Parts::of(&vector("mixed"));
    let known = sound(&parts.whole(), &Limits::default()).unwrap();
    let mut optional = parts.clone();
    optional.chunks.insert(1, (*b"NEW?", 2, u32::MAX, vec![1, 2, 3]));
    assert_eq!(sound(&optional.whole(), &Limits::default()).unwrap(), known);
    let info = inspect(&optional.whole(), &Limits::default()).unwrap();
    assert!(!info.chunks[1].known && info.chunks[1].coded_bytes == 3);
    let mut required = parts.clone();
    required.chunks.push((*b"NEW!", 1, 3, vec![1, 2, 3]));
    assert!(refused(&required.whole()).contains("NEW!"));
    for n in 0..parts.chunks.len() {
        let mut missing = parts.clone();
        let id = missing.chunks.remove(n).0;
        let message = refused(&missing.whole());
        assert!(!message.is_empty(), "{id:?}");
        let mut doubled = parts.clone();
        doubled.chunks.push(doubled.chunks[n].clone());
        assert!(refused(&doubled.whole()).contains("twice"));
        let mut coded = parts.clone();
        coded.chunks[n].1 ^= 2;
        refused(&coded.whole());
    }
    let mut parts = parts;
    let raw = parts.chunk(b"COLR").2;
    let zipped = zstd::bulk::compress(parts.bare(b"COLR"), 19).unwrap()[4..].to_vec();
    *parts.chunk(b"COLR") = (*b"COLR", 2, raw, zipped);
    assert_eq!(sound(&parts.whole(), &Limits::default()).unwrap(), known);
    for wrong in [0, raw - 1, raw + 1, raw * 2, 1 << 30, u32::MAX] {
        let mut other = parts.clone();
        other.chunk(b"COLR").2 = wrong;
        refused(&other.whole());
    }
}

#[test]
fn chunks_without_end_or_by_names_that_they_do_not_have() {
    let parts = Parts::of(&vector("mixed"));
    let known = sound(&parts.whole(), &Limits::default()).unwrap();
    let with = |more: &[u8]| {
        let whole = parts.whole();
        sealed(&[&whole[..whole.len() - 4], more].concat())
    };
    assert_eq!(sound(&with(b"\x00NEW?\x01x"), &Limits::default()).unwrap(), known);
    for (more, words) in [
        (&b"\x10\x01x"[..], "number 4"),
        (b"\xfe\x01\x01x", "number 63"),
        (b"\x00PART\x01x", "spelt out"),
        (b"\x00NEW?\x02x", "needs 2 bytes"),
        (b"\x00NEW?\xff\xff\xff\xff\x0f", "needs 4294967295 bytes"),
        (b"\x00NEW?\xff\xff\xff\xff\x1f", "32 bits"),
        (b"\x00NEW?\x81\x00x", "idle"),
    ] {
        let message = refused(&with(more));
        assert!(message.contains(words), "{message}");
    }
    let mut crowd = parts.clone();
    let id = |n: usize| [b'N', b'0' + (n / 100) as u8, b'0' + (n / 10 % 10) as u8, b'0' + (n % 10) as u8];
    crowd.chunks.extend((crowd.chunks.len()..255).map(|n| (id(n), 0, 1, vec![n as u8])));
    assert_eq!(sound(&crowd.whole(), &Limits::default()).unwrap(), known);
    crowd.chunks.push((*b"LAST", 0, 1, vec![0]));
    assert!(refused(&crowd.whole()).contains("255"));
}

#[test]
fn splats_too_few_too_many_or_out_of_range() {
    let parts = Parts::of(&vector("mixed"));
    for tail in [&[0][..], &[1], &[0; 100]] {
        let mut long = parts.clone();
        long.bare(b"SPLT").extend(tail);
        long.chunk(b"SPLT").2 += tail.len() as u32;
        assert!(refused(&long.whole()).contains("holds more"), "{tail:?}");
    }
    for left in 1..parts.clone().bare(b"SPLT").len() {
        let mut short = parts.clone();
        short.bare(b"SPLT").truncate(left);
        short.chunk(b"SPLT").2 = left as u32;
        refused(&short.whole());
    }
    // The first kind, the first step along the curve: whatever they become, numbers go out of range or on.
    for byte in 0..=u8::MAX {
        let mut wild = parts.clone();
        let first = &mut wild.bare(b"SPLT")[0];
        if *first != byte {
            *first = byte;
            refused(&wild.whole());
        }
    }
}

#[test]
fn partners_must_be_announced_and_be_there() {
    let parts = Parts::of(&vector("partnered"));
    let mut silent = parts.clone();
    *silent.field("optional") = vec![0];
    assert!(refused(&silent.whole()).contains("optional features"));
    let mut without = parts.clone();
    without.chunks.retain(|chunk| chunk.0 != *b"PART");
    assert!(refused(&without.whole()).contains("optional features"));
    *without.field("optional") = vec![0];
    let whole = sound(&without.whole(), &Limits::default()).unwrap();
    assert!(whole.splats.iter().all(|splat| splat.partners.is_empty()));
    for (at, byte) in [(0, 2), (1, 200), (2, 255)] {
        let mut broken = parts.clone();
        broken.bare(b"PART")[at] = byte;
        assert!(refused(&broken.whole()).contains("PART"), "byte {at}");
    }
    let mut longer = parts;
    longer.bare(b"PART").push(0);
    longer.chunk(b"PART").2 += 1;
    assert!(refused(&longer.whole()).contains("PART"));
}

#[test]
fn bombs_do_not_go_off() {
    // A frame of a gigabyte of zeros where a hundred bytes are announced, and the other way.
    let zeros = zstd::bulk::compress(&vec![0; 1 << 26], 19).unwrap()[4..].to_vec();
    let parts = Parts::of(&vector("mixed"));
    for id in [*b"SPLT", *b"COLR"] {
        let mut bomb = parts.clone();
        let chunk = bomb.chunk(&id);
        (chunk.1, chunk.3) = (chunk.1 | 2, zeros.clone());
        refused(&bomb.whole());
        bomb.chunk(&id).2 = 1 << 26;
        refused(&bomb.whole());
        // Even where the counts allow the length, the limits do not.
        refused(&bomb.with("splats", &varint(1 << 22)).with("straight", &[0]).whole());
    }
    // Few bytes cannot stand for many splats.
    let many = parts.with("splats", &varint(1 << 22));
    assert!(refused(&many.whole()).contains("too few"));
    let tight = Limits { decoded_bytes: 1000, ..Limits::default() };
    assert!(matches!(decode(&vector("mixed"), &tight), Err(Error::Limits { .. })));
    for tight in [
        Limits { splats: 119, ..Limits::default() },
        Limits { clips: 5, ..Limits::default() },
        Limits { file_bytes: 100, ..Limits::default() },
    ] {
        assert!(matches!(decode(&vector("mixed"), &tight), Err(Error::Limits { .. })), "{tight:?}");
    }
}

#[test]
fn mutations_with_checksums_that_fit() {
    let mut state = 0x1234_5678_u64;
    let mut random = move |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    let (mut accepted, mut tried) = (0, 0);
    for name in ["mixed", "steep", "worked-example", "partnered"] {
        let mut parts = Parts::of(&vector(name));
        // Half of the trials change what lies under zstd, which zstd itself would catch.
        let ids: Vec<[u8; 4]> = parts.chunks.iter().map(|chunk| chunk.0).collect();
        let coded = parts.clone();
        for id in &ids {
            parts.bare(id);
        }
        for trial in 0..4000 {
            let mut broken = if trial % 2 == 0 { parts.clone() } else { coded.clone() };
            for _ in 0..1 + random(4) {
                let chunk = random(broken.chunks.len() + 1);
                let place = match chunk.checked_sub(1) {
                    Some(chunk) => &mut broken.chunks[chunk].3,
                    None => &mut broken.header[random(FIELDS.len())],
                };
                if place.is_empty() {
                    continue;
                }
                let at = random(place.len());
                place[at] = match random(3) {
                    0 => place[at] ^ (1 << random(8)),
                    1 => random(256) as u8,
                    _ => place[at].wrapping_add(1),
                };
            }
            tried += 1;
            accepted += usize::from(sound(&broken.whole(), &Limits::default()).is_ok());
        }
    }
    println!("{accepted} of {tried} mutations were accepted, all of them sound");
    // On Linux the most memory the process ever held shows what the decoder asked for.
    if let Ok(status) = std::fs::read_to_string("/proc/self/status") {
        let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).unwrap();
        let kib: u64 = peak.trim().trim_end_matches(" kB").parse().unwrap();
        println!("peak memory {kib} KiB");
        assert!(kib < 512 << 10);
    }
    // Both outcomes occur, so the test sees behind the checksums.
    assert!(accepted > tried / 20 && accepted < tried);
}
