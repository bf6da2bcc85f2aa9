//! The border of a splat's clipped domain, piece by piece, each a conic in standard form.
//!
//! Walked from `P1` to `P3` every piece has the domain on its left.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::roots;
use crate::model::clip_curve::Conic;
use crate::model::splat::Splat;

/// What a piece of the border belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// The ellipse.
    Rim,
    /// A clip curve.
    Clip,
}

/// A piece of the border.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    pub(super) conic: Conic,
    pub(super) kind: Kind,
}

/// Arcs that the ellipse is taken apart into, so that each is flat.
const ARCS: usize = 8;

/// A clip curve is halved until its height is at most this share of its chord, much as an arc's.
const FLAT: f64 = 0.1;

/// And until its chord is at most this many radii long, much as an arc's, so that lifted on the
/// quadric it is flat too.
const ACROSS: f64 = 0.8;

/// Halvings at most. Shapes next to 1 halve their distance from the parabola in each.
const DEPTH: u32 = 12;

/// Whether a piece belongs to the border is decided this share of the radii inside it:
/// far above the rounding of the predicates, far below anything that can be seen.
const INSIDE: f64 = 1e-9;

/// Pieces shorter than this share of their curve are the rounding of one crossing.
const SHORTEST: f64 = 1e-12;

/// The whole border; empty if nothing is left of the splat.
pub(super) fn border(splat: &Splat, conics: &[Conic]) -> Vec<Piece> {
    let mut pieces = Vec::new();
    for arc in arcs(splat.radii) {
        let mut places = Vec::new();
        conics.iter().for_each(|conic| crossings(&arc, conic, &mut places));
        let kept = |inside: DVec2| !conics.iter().any(|conic| conic.cuts(inside));
        split(splat, &arc, places, Kind::Rim, &kept, &mut pieces);
    }
    for (n, clip) in conics.iter().enumerate().filter(|(n, clip)| !conics[..*n].contains(clip)) {
        let kept = |inside: DVec2| {
            let others = conics.iter().enumerate().filter(|&(m, conic)| m != n && conic != clip);
            splat.ellipse(inside) <= 1.0 && !others.map(|(_, conic)| conic).any(|conic| conic.cuts(inside))
        };
        let mut leaves = Vec::new();
        flatten(clip, splat.radii, &mut leaves);
        for leaf in leaves {
            let mut places = Vec::new();
            ellipse_crossings(&leaf, splat.radii, &mut places);
            let others = conics.iter().enumerate().filter(|&(m, _)| m != n);
            others.for_each(|(_, conic)| crossings(&leaf, conic, &mut places));
            split(splat, &leaf, places, Kind::Clip, &kept, &mut pieces);
        }
    }
    pieces
}

/// The ellipse as arcs, counter-clockwise.
fn arcs(radii: DVec2) -> impl Iterator<Item = Conic> {
    let half = 0.5 * TAU / ARCS as f64;
    let weight = libm::cos(half);
    (0..ARCS).map(move |n| {
        let at = |angle: f64| {
            let (sin, cos) = libm::sincos(angle);
            radii * DVec2::new(cos, sin)
        };
        let middle = (2 * n + 1) as f64 * half;
        // A conic arc of a circle has the cosine of half its angle for its weight.
        let next = (n + 1) % ARCS;
        let rho = weight / (1.0 + weight);
        Conic {
            p1: at(2.0 * half * n as f64),
            p2: at(middle) / weight,
            p3: at(2.0 * half * next as f64),
            rho,
        }
    })
}

/// Halves a clip curve into flat leaves, less what surely lies outside the ellipse.
fn flatten(clip: &Conic, radii: DVec2, leaves: &mut Vec<Conic>) {
    let straight = |p1: DVec2, p3: DVec2| Conic { p1, p2: p1.midpoint(p3), p3, rho: 0.0 };
    if clip.rho == 0.0 || (clip.p2 - clip.p1).perp_dot(clip.p3 - clip.p1) == 0.0 {
        halve(&straight(clip.p1, clip.p3), radii, DEPTH, leaves);
    } else if clip.rho < 1.0 {
        halve(clip, radii, DEPTH, leaves);
    } else {
        // At rho = 1 the curve is its control polygon.
        for leg in [straight(clip.p1, clip.p2), straight(clip.p2, clip.p3)] {
            halve(&leg, radii, DEPTH, leaves);
        }
    }
}

fn halve(conic: &Conic, radii: DVec2, depth: u32, leaves: &mut Vec<Conic>) {
    let corners = [conic.p1, conic.p2, conic.p3];
    let max = corners.into_iter().fold(DVec2::NEG_INFINITY, DVec2::max);
    let min = corners.into_iter().fold(DVec2::INFINITY, DVec2::min);
    if min.cmpgt(radii).any() || max.cmplt(-radii).any() {
        return;
    }
    let (chord, across) = (conic.p3 - conic.p1, ((conic.p3 - conic.p1) / radii).length());
    if depth == 0 || (across <= ACROSS && height(conic) <= FLAT * chord.length()) {
        leaves.push(*conic);
        return;
    }
    halve(&part(conic, 0.0, 0.5), radii, depth - 1, leaves);
    halve(&part(conic, 0.5, 1.0), radii, depth - 1, leaves);
}

/// A conic goes no farther from its chord than this, the way of its shoulder.
pub(super) fn height(conic: &Conic) -> f64 {
    conic.rho * conic.p2.distance(conic.p1.midpoint(conic.p3))
}

/// Homogeneous coefficients of a conic by powers of its parameter: `[x w, y w, w]`.
fn powers(conic: &Conic) -> [DVec3; 3] {
    let [b0, b1, b2] = controls(conic);
    if conic.rho == 0.0 {
        return [b0, b2 - b0, DVec3::ZERO];
    }
    [b0, 2.0 * (b1 - b0), b0 - 2.0 * b1 + b2]
}

/// Homogeneous control points.
fn controls(conic: &Conic) -> [DVec3; 3] {
    let [outer, inner] = [1.0 - conic.rho, conic.rho];
    [outer * conic.p1.extend(1.0), inner * conic.p2.extend(1.0), outer * conic.p3.extend(1.0)]
}

/// A part of a conic, in standard form again: its blossom (Farin, *NURBS*, section 5.4).
fn part(conic: &Conic, from: f64, to: f64) -> Conic {
    if conic.rho == 0.0 {
        let (p1, p3) = (conic.p1.lerp(conic.p3, from), conic.p1.lerp(conic.p3, to));
        return Conic { p1, p2: p1.midpoint(p3), p3, rho: 0.0 };
    }
    let [b0, b1, b2] = controls(conic);
    let blossom =
        |s: f64, t: f64| (1.0 - s) * (1.0 - t) * b0 + ((1.0 - s) * t + s * (1.0 - t)) * b1 + s * t * b2;
    let [q0, q1, q2] = [blossom(from, from), blossom(from, to), blossom(to, to)];
    let place = |q: DVec3| q.truncate() / q.z;
    let rho = q1.z / (q1.z + libm::sqrt(q0.z * q2.z));
    Conic { p1: place(q0), p2: place(q1), p3: place(q2), rho }
}

/// Parameters at which a leaf may cross the border of what a clip curve cuts away.
fn crossings(leaf: &Conic, clip: &Conic, places: &mut Vec<f64>) {
    let powers = powers(leaf);
    // The doubled area of `a, b, x`, homogeneous in `x`.
    let area = |a: DVec2, b: DVec2| {
        let side = b - a;
        let form = DVec3::new(-side.y, side.x, side.y * a.x - side.x * a.y);
        powers.map(|power| form.dot(power))
    };
    let (l1, l2, l3) = (area(clip.p2, clip.p3), area(clip.p1, clip.p3), area(clip.p1, clip.p2));
    if clip.rho == 0.0 || (clip.p2 - clip.p1).perp_dot(clip.p3 - clip.p1) == 0.0 {
        places.extend(roots::polynomial(&l2, 0.0, 1.0));
    } else if clip.rho < 1.0 {
        let (chordal, curved) = (1.0 - clip.rho, 2.0 * clip.rho);
        let (squared, product) = (product(&l2, &l2), product(&l1, &l3));
        let form: [f64; 5] =
            std::array::from_fn(|n| chordal * chordal * squared[n] - curved * curved * product[n]);
        places.extend(roots::polynomial(&form, 0.0, 1.0));
    } else {
        places.extend(roots::polynomial(&l1, 0.0, 1.0));
        places.extend(roots::polynomial(&l3, 0.0, 1.0));
    }
}

/// Parameters at which a leaf crosses the ellipse.
fn ellipse_crossings(leaf: &Conic, radii: DVec2, places: &mut Vec<f64>) {
    let powers = powers(leaf);
    let row = |of: fn(&DVec3) -> f64, scale: f64| {
        let row = [0, 1, 2].map(|n| of(&powers[n]) / scale);
        product(&row, &row)
    };
    let (x, y, w) = (row(|p| p.x, radii.x), row(|p| p.y, radii.y), row(|p| p.z, 1.0));
    let form: [f64; 5] = std::array::from_fn(|n| x[n] + y[n] - w[n]);
    places.extend(roots::polynomial(&form, 0.0, 1.0));
}

fn product(a: &[f64; 3], b: &[f64; 3]) -> [f64; 5] {
    let mut product = [0.0; 5];
    for (n, x) in a.iter().enumerate() {
        for (m, y) in b.iter().enumerate() {
            product[n + m] += x * y;
        }
    }
    product
}

/// Adds the parts of a leaf between places whose middle, just inside, is `kept`.
fn split(
    splat: &Splat,
    leaf: &Conic,
    mut places: Vec<f64>,
    kind: Kind,
    kept: &dyn Fn(DVec2) -> bool,
    pieces: &mut Vec<Piece>,
) {
    places.extend([0.0, 1.0]);
    places.sort_unstable_by(f64::total_cmp);
    for pair in places.windows(2).filter(|pair| pair[1] - pair[0] > SHORTEST) {
        let conic = part(leaf, pair[0], pair[1]);
        // On the disc of radius 1 that the ellipse is when divided by its radii.
        let along = ((conic.p3 - conic.p1) / splat.radii).normalize_or_zero();
        let middle = conic.p1.midpoint(conic.p3).lerp(conic.p2, conic.rho);
        if kept(middle + INSIDE * splat.radii * along.perp()) {
            pieces.push(Piece { conic, kind });
        }
    }
}
