//! Hostile bytes: every prefix, every byte changed, random edits. Nothing may panic or hang.

use super::super::scalar::Endian;
use super::{edges, ply, read};

/// A small linear congruential generator (Knuth's MMIX constants): the same edits every run.
struct Random(u64);

impl Random {
    fn below(&mut self, limit: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % limit
    }
}

fn samples() -> Vec<(&'static str, Vec<u8>)> {
    let ascii = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
        property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 2\n\
        property list uchar int vertex_indices\nelement edge 1\nproperty int vertex1\nproperty int vertex2\n\
        end_header\n0 0 0 1 2 3\n1 0 0 1 2 3\n0 1 0 1 2 3\n1 1 1 1 2 3\n3 0 1 2\n4 3 2 1 0\n0 3\n";
    let strips =
        b"ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty char x\nproperty char y\n\
        property char z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n\
        \0\0\0\x01\0\0\0\x01\0\x01\x01\x01\x04\0\0\0\0\0\0\0\x01\0\0\0\x02\0\0\0\x03\0\0\0";
    let obj = "v 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvt 0 0\nf 1/1/1 2//1 3\nf -3 -2 \\\n-1\nl 1 2 3\n";
    let off = "CNOFF\n3 1 0\n0 0 0 0 0 1 9 9 9\n1 0 0 0 0 1 9 9 9\n0 1 0 0 0 1 9 9 9\n3 0 1 2\n";
    let utf16 = obj.encode_utf16().flat_map(u16::to_be_bytes);
    let samples = vec![
        ("ascii.ply", ascii.as_bytes().to_vec()),
        ("little.ply", ply::tetrahedron(["double", "uchar", "int"], Endian::Little)),
        ("big.ply", ply::tetrahedron(["float", "char", "ushort"], Endian::Big)),
        ("strips.ply", strips.to_vec()),
        ("a.obj", obj.as_bytes().to_vec()),
        ("utf16.obj", [0xfe, 0xff].into_iter().chain(utf16).collect()),
        ("a.off", off.as_bytes().to_vec()),
    ];
    #[cfg(feature = "gltf")]
    let samples = [
        samples,
        vec![
            ("a.glb", super::gltf_file::triangle().to_glb()),
            ("textured.glb", super::gltf_file::textured([0.25, 0.5]).to_glb()),
            ("a.gltf", super::gltf_file::triangle().to_gltf()),
        ],
    ]
    .concat();
    samples
}

#[test]
fn samples_are_sound_to_begin_with() {
    for (name, bytes) in samples() {
        assert!(read(name, &bytes).is_ok(), "{name}: {:?}", read(name, &bytes));
    }
}

#[test]
fn every_prefix_ends_well() {
    for (name, bytes) in samples() {
        let accepted = (0..bytes.len()).filter(|&end| read(name, &bytes[..end]).is_ok()).count();
        (0..bytes.len()).for_each(|end| drop(edges(name, &bytes[..end])));
        let is_text = name.ends_with("obj") || name == "ascii.ply" || name == "a.off";
        // A text may lose its end, and the last element of `ascii.ply` is not needed; a binary
        // file may not lose a byte.
        assert!(is_text || accepted <= usize::from(name == "utf16.obj"), "{name}: {accepted}");
    }
}

#[test]
fn every_changed_byte_ends_well() {
    for (name, bytes) in samples() {
        for place in 0..bytes.len() {
            for change in [0x01, 0x80, 0xff, bytes[place]] {
                let mut changed = bytes.clone();
                changed[place] ^= change;
                drop(read(name, &changed));
                drop(edges(name, &changed));
            }
        }
    }
}

#[test]
fn random_edits_end_well() {
    let mut random = Random(0x5eed);
    for (name, bytes) in samples() {
        for _ in 0..2000 {
            let mut changed = bytes.clone();
            for _ in 0..=random.below(4) {
                let (from, to) = (random.below(changed.len()), random.below(changed.len()));
                match random.below(4) {
                    0 => changed[from] = random.below(256) as u8,
                    1 => changed[from] = changed[to],
                    2 => drop(changed.remove(from)),
                    _ => changed.insert(from, b"0123456789-/.\n x"[random.below(16)]),
                }
            }
            drop(read(name, &changed));
            drop(edges(name, &changed));
        }
    }
}
