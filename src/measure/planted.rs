//! Surfaces with known errors, for tests.
#![allow(clippy::unwrap_used)]

use glam::{DMat3, DVec2, DVec3, Vec3};

use crate::analyse::cloud_normals::NormalSource;
use crate::analyse::cloud_surface::{Lines, cloud_discs};
use crate::model::asset::{Accuracy, Asset};
use crate::model::clip_curve::ClipCurve;
use crate::model::cloud::Cloud;
use crate::model::discs::Discs;
use crate::model::mesh::Mesh;
use crate::model::splat::Splat;

/// An asset in the default frame.
pub(super) fn asset(splats: Vec<Splat>) -> Asset {
    let frame = crate::model::frame::Frame::default();
    let fit = Accuracy::default();
    Asset { frame, diagonal: 2.0, max_error: 1e-3, fit, has_colors: false, splats }
}

/// A flat splat in the plane `z = 0`.
pub(super) fn flat(center: DVec3, radii: DVec2, clips: Vec<ClipCurve>) -> Splat {
    Splat {
        center,
        axes: DMat3::IDENTITY,
        radii,
        curvature: DVec2::ZERO,
        clips,
        partners: Vec::new(),
        color: [255; 3],
    }
}

/// A mesh of the default frame.
pub(super) fn mesh(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Mesh {
    let positions = positions.into_iter().map(DVec3::as_vec3).collect();
    Mesh { vertices: Cloud { positions, ..Cloud::default() }, triangles, ..Mesh::default() }
}

/// The surface that a cloud tells of, without lines and without points that belong to none.
pub(super) fn discs(cloud: &Cloud) -> Discs {
    let found = cloud_discs(cloud, NormalSource::Auto, Lines::Given(&[]), None).unwrap();
    assert_eq!(found.left_out.len(), 0);
    found.discs
}

/// The square `[-1, 1]²` in the plane `z = 0`, as a lattice of `2 side²` triangles.
pub(super) fn square(side: u32) -> Mesh {
    let at = |n: u32| f64::from(n) / f64::from(side) * 2.0 - 1.0;
    let row = side + 1;
    let positions = (0..row * row).map(|n| DVec3::new(at(n % row), at(n / row), 0.0)).collect();
    let cells = (0..side * side).map(|n| n % side + n / side * row);
    let triangles = cells.flat_map(|a| [[a, a + 1, a + row + 1], [a, a + row + 1, a + row]]).collect();
    mesh(positions, triangles)
}

/// A ball as a fine lattice of longitude and latitude.
pub(super) fn ball(radius: f64, rows: u32) -> Mesh {
    let columns = 2 * rows;
    let positions = (0..(rows + 1) * columns).map(|n| {
        let (sin, cos) = libm::sincos(std::f64::consts::PI * f64::from(n / columns) / f64::from(rows));
        let (east, north) = libm::sincos(std::f64::consts::PI * f64::from(n % columns) / f64::from(rows));
        radius * DVec3::new(sin * north, sin * east, cos)
    });
    let quads = (0..rows * columns).map(|n| {
        let right = n / columns * columns + (n + 1) % columns;
        [n, n + columns, right, right + columns]
    });
    let triangles = quads.flat_map(|[a, b, c, d]| [[a, b, c], [c, b, d]]);
    let positions: Vec<DVec3> = positions.collect();
    let at = |v: u32| positions[v as usize].as_vec3();
    let sound = |t: &[u32; 3]| {
        let [a, b, c]: [Vec3; 3] = t.map(at);
        (b - a).cross(c - a).length() > 1e-12
    };
    let triangles = triangles.filter(sound).collect();
    mesh(positions, triangles)
}

/// Small quadric splats that osculate a sphere, evenly spread.
pub(super) fn sphere(radius: f64, count: u32, reach: f64) -> Vec<Splat> {
    let splat = |n: u32| {
        let z = 1.0 - (2.0 * f64::from(n) + 1.0) / f64::from(count);
        let (sin, cos) = libm::sincos(f64::from(n) * 2.399_963_229_728_653);
        let k = (1.0 - z * z).sqrt() * DVec3::new(cos, sin, 0.0) + z * DVec3::Z;
        let (i, j) = k.any_orthonormal_pair();
        Splat {
            center: radius * k,
            axes: DMat3::from_cols(i, j, i.cross(j) * i.cross(j).dot(k).signum()),
            radii: DVec2::splat(reach),
            curvature: DVec2::splat(-0.5 / radius),
            clips: vec![],
            partners: Vec::new(),
            color: [255; 3],
        }
    };
    (0..count).map(splat).collect()
}
