//! The decoder under torture: whatever the bytes, it gives an error or a sound asset, without
//! a panic and without allocating more than the limits allow.

#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout)]

use std::path::Path;

use qsplat::Error;
use qsplat::format::{Limits, decode, inspect};
use qsplat::model::asset::Asset;

/// Bytes before the table of chunks.
const HEADER: usize = 96;
/// Where the achieved error begins, in numbers of 32 bits; those before it have 64.
const FIT: usize = 84;
/// Bytes of a table entry.
const ENTRY: usize = 17;

fn vector(name: &str) -> Vec<u8> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("fixtures/vectors/{name}.qsplat"));
    std::fs::read(path).unwrap()
}

/// A file taken apart, so that it can be put together wrongly.
#[derive(Clone)]
struct Parts {
    header: Vec<u8>,
    /// Id, flags, raw length, bytes.
    chunks: Vec<([u8; 4], u8, u32, Vec<u8>)>,
}

impl Parts {
    fn of(bytes: &[u8]) -> Self {
        let count = usize::from(bytes[10]);
        let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
        let mut at = HEADER + count * ENTRY + 4;
        let mut chunks = Vec::new();
        for entry in (0..count).map(|n| HEADER + n * ENTRY) {
            let length = word(entry + 9) as usize;
            let id = bytes[entry..entry + 4].try_into().unwrap();
            chunks.push((id, bytes[entry + 4], word(entry + 5), bytes[at..at + length].to_vec()));
            at += length;
        }
        Self { header: bytes[..HEADER].to_vec(), chunks }
    }

    /// Whole again, with lengths and checksums that fit.
    fn whole(&self) -> Vec<u8> {
        let mut out = self.header.clone();
        out[10] = self.chunks.len() as u8;
        for (id, flags, raw, bytes) in &self.chunks {
            out.extend(id);
            out.push(*flags);
            out.extend(raw.to_le_bytes());
            out.extend((bytes.len() as u32).to_le_bytes());
            out.extend(crc32fast::hash(bytes).to_le_bytes());
        }
        out.extend(crc32fast::hash(&out).to_le_bytes());
        self.chunks.iter().for_each(|chunk| out.extend(&chunk.3));
        out
    }

    fn chunk(&mut self, id: &[u8; 4]) -> &mut ([u8; 4], u8, u32, Vec<u8>) {
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
    let float = |x: f64| x.to_le_bytes().to_vec();
    let mut bad: Vec<(usize, Vec<u8>)> = vec![
        (8, vec![0, 0]),
        (8, vec![1, 0]),
        (8, vec![3, 0]),
        (8, vec![0xff, 0xff]),
        (11, vec![1]),
        (32, vec![0]),
        (33, vec![13]),
        (34, vec![13]),
        (35, vec![0]),
        (36, vec![0]),
        (37, vec![0]),
        (38, vec![0]),
        (39, vec![4]),
        (40, 1001_i32.to_le_bytes().to_vec()),
        (40, i32::MIN.to_le_bytes().to_vec()),
    ];
    for bit in 0..32_u32 {
        let required = u32::from_le_bytes(parts.header[12..16].try_into().unwrap());
        bad.push((12, (required ^ (1 << bit)).to_le_bytes().to_vec()));
    }
    for at in [20, 24, 28] {
        let count = u32::from_le_bytes(parts.header[at..at + 4].try_into().unwrap());
        for wrong in [0, count - 1, count + 1, 1 << 22, (1 << 22) + 1, u32::MAX] {
            bad.push((at, wrong.to_le_bytes().to_vec()));
        }
    }
    for at in (44..FIT).step_by(8) {
        for wrong in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            bad.push((at, float(wrong)));
        }
    }
    for at in (68..FIT).step_by(8) {
        bad.push((at, float(-1.0)));
    }
    for at in (FIT..HEADER).step_by(4) {
        for wrong in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0] {
            bad.push((at, wrong.to_le_bytes().to_vec()));
        }
    }
    for (at, wrong) in [(68, 0.0), (68, 1e-300), (68, 1e300), (76, 0.0), (76, 1e-300), (76, 1e9), (76, 1e-8)]
    {
        bad.push((at, float(wrong)));
    }
    for (at, wrong) in bad {
        let mut broken = parts.clone();
        broken.header[at..at + wrong.len()].copy_from_slice(&wrong);
        let message = refused(&broken.whole());
        assert!(!message.is_empty(), "{at}");
    }
    // Unknown optional features change nothing.
    let mut newer = parts.clone();
    newer.header[19] = 0x80;
    let asset = sound(&newer.whole(), &Limits::default()).unwrap();
    assert_eq!(asset, sound(&parts.whole(), &Limits::default()).unwrap());
}

#[test]
fn chunks_that_are_unknown_missing_doubled_or_of_another_length() {
    let parts = Parts::of(&vector("mixed"));
    let known = sound(&parts.whole(), &Limits::default()).unwrap();
    let mut optional = parts.clone();
    optional.chunks.insert(1, (*b"NEW?", 0, u32::MAX, vec![1, 2, 3]));
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
        for flags in [4, 0x80] {
            let mut flagged = parts.clone();
            flagged.chunks[n].1 |= flags;
            refused(&flagged.whole());
        }
        let raw = parts.chunks[n].2;
        for wrong in [0, raw - 1, raw + 1, raw * 2, 1 << 30, u32::MAX] {
            let mut other = parts.clone();
            other.chunks[n].2 = wrong;
            refused(&other.whole());
        }
        let mut coded = parts.clone();
        coded.chunks[n].1 ^= 2;
        refused(&coded.whole());
    }
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
    silent.header[16] = 0;
    assert!(refused(&silent.whole()).contains("optional features"));
    let mut without = parts.clone();
    without.chunks.retain(|chunk| chunk.0 != *b"PART");
    assert!(refused(&without.whole()).contains("optional features"));
    without.header[16] = 0;
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
        bomb.header[20..24].copy_from_slice(&(1_u32 << 22).to_le_bytes());
        bomb.header[24..28].copy_from_slice(&0_u32.to_le_bytes());
        refused(&bomb.whole());
    }
    // Few bytes cannot stand for many splats.
    let mut many = parts;
    many.header[20..24].copy_from_slice(&(1_u32 << 22).to_le_bytes());
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
                let place = if chunk == 0 { &mut broken.header } else { &mut broken.chunks[chunk - 1].3 };
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
