// The inside test of clip curves; twin of `model::clip_curve::Conic::cuts`, which explains
// it. Curves are given over the unit disc.

struct Conic {
    p1: vec2<f32>,
    p2: vec2<f32>,
    p3: vec2<f32>,
    rho: f32,
    _pad: f32,
}

@group(0) @binding(1) var<storage, read> conics: array<Conic>;

// Twice the signed area of a triangle.
fn area_of(a: vec2<f32>, b: vec2<f32>, c: vec2<f32>) -> f32 {
    let p = b - a;
    let q = c - a;
    return p.x * q.y - p.y * q.x;
}

// Whether the place lies to the right of the curve.
fn cuts(conic: Conic, q: vec2<f32>) -> bool {
    let chord = area_of(conic.p1, conic.p3, q);
    let area = area_of(conic.p1, conic.p2, conic.p3);
    if conic.rho == 0.0 || area == 0.0 {
        return chord < 0.0;
    }
    let side = sign(area);
    let l1 = side * area_of(q, conic.p2, conic.p3);
    let l2 = -side * chord;
    let l3 = side * area_of(conic.p1, conic.p2, q);
    let chordal = (1.0 - conic.rho) * l2;
    let bulge = l2 > 0.0 && l2 < conic.rho * abs(area) && l1 > 0.0 && l3 > 0.0
        && chordal * chordal < 4.0 * conic.rho * conic.rho * l1 * l3;
    let inner = l2 <= 0.0 || bulge;
    return select(inner, !inner, area > 0.0);
}

// How fast the doubled area of a triangle from a to b grows with the place, by axes shrunk by scale.
fn slope_of(a: vec2<f32>, b: vec2<f32>, scale: vec2<f32>) -> vec2<f32> {
    return vec2<f32>(a.y - b.y, b.x - a.x) / scale;
}

// Farther than any place is from a curve.
const NOT_NEAR: f32 = 1e30;

fn off_by(f: f32, slope: vec2<f32>) -> f32 {
    let steep = length(slope);
    return select(select(sign(f) * NOT_NEAR, f / steep, steep > 0.0), 0.0, f == 0.0);
}

// Whether a place lies farther along the way from a to b than b.
fn goes_on(a: vec2<f32>, b: vec2<f32>, q: vec2<f32>, scale: vec2<f32>) -> bool {
    return dot((q - b) * scale, (b - a) * scale) > 0.0;
}

// How far a place lies from the curve; twin of `Conic::distance`, which explains it.
fn distance_from(conic: Conic, q: vec2<f32>, scale: vec2<f32>) -> f32 {
    let s1 = slope_of(conic.p2, conic.p3, scale);
    let s2 = slope_of(conic.p3, conic.p1, scale);
    let s3 = slope_of(conic.p1, conic.p2, scale);
    let area = area_of(conic.p1, conic.p2, conic.p3);
    let chord = area_of(conic.p3, conic.p1, q);
    if conic.rho == 0.0 || area == 0.0 {
        return off_by(abs(chord), s2);
    }
    let side = sign(area);
    let l1 = side * area_of(conic.p2, conic.p3, q);
    let l2 = side * chord;
    let l3 = side * area_of(conic.p1, conic.p2, q);
    let outside = max(max(off_by(-l1, s1), off_by(-l2, s2)), off_by(-l3, s3));
    let chordal = (1.0 - conic.rho) * l2;
    let product = 4.0 * conic.rho * conic.rho * l1 * l3;
    let curved = sqrt(max(product, 0.0));
    let level = (1.0 - conic.rho) * s2;
    let bent = 2.0 * conic.rho * conic.rho * (l1 * s3 + l3 * s1);
    let on_side = conic.rho <= 0.5 && curved > 0.0 && chordal < curved;
    let along = select(chordal, max(chordal, 0.0), on_side);
    let whole = off_by(abs(along * along - product), 2.0 * (along * level - bent));
    var least = whole;
    if on_side {
        least = min(whole, off_by(curved - chordal, bent / curved - level));
    }
    least = max(least, outside);
    if goes_on(conic.p2, conic.p3, q, scale) {
        least = min(least, off_by(abs(l1), s1));
    }
    if goes_on(conic.p2, conic.p1, q, scale) {
        least = min(least, off_by(abs(l3), s3));
    }
    return least;
}

// How far a place lies from the nearest of a splat's curves.
fn clearance(first: u32, count: u32, q: vec2<f32>, scale: vec2<f32>) -> f32 {
    var least = NOT_NEAR;
    for (var n = first; n < first + count; n++) {
        least = min(least, distance_from(conics[n], q, scale));
    }
    return least;
}

// Whether any of a splat's curves cuts the place away.
fn clipped_away(first: u32, count: u32, q: vec2<f32>) -> bool {
    for (var n = first; n < first + count; n++) {
        if cuts(conics[n], q) {
            return true;
        }
    }
    return false;
}
