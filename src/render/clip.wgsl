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

// Whether any of a splat's curves cuts the place away.
fn clipped_away(first: u32, count: u32, q: vec2<f32>) -> bool {
    for (var n = first; n < first + count; n++) {
        if cuts(conics[n], q) {
            return true;
        }
    }
    return false;
}
