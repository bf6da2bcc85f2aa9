// The screen bound of a splat; twin of `project.rs`, which explains it.

// Upper left and lower right corner in samples; `shown` is false behind the near plane.
struct Bound {
    low: vec2<f32>,
    high: vec2<f32>,
    shown: bool,
}

// A box of the picture's plane.
struct Extent {
    low: vec2<f32>,
    high: vec2<f32>,
}

fn join(a: Extent, b: Extent) -> Extent {
    return Extent(min(a.low, b.low), max(a.high, b.high));
}

// Extent of an ellipse's picture, measured from the picture of its centre.
fn ellipse_extent(center: vec3<f32>, u: vec3<f32>, v: vec3<f32>, spread: f32) -> Extent {
    if eye.perspective == 0u {
        let half = sqrt(u.xy * u.xy + v.xy * v.xy);
        return Extent(center.xy - half, center.xy + half);
    }
    let depth = eye.anchor_depth + center.z;
    let p = center.xy / depth;
    let du = u.xy - p * u.z;
    let dv = v.xy - p * v.z;
    let square = (depth - spread) * (depth + spread);
    let linear = du * u.z + dv * v.z;
    let root = sqrt(linear * linear + square * (du * du + dv * dv));
    return Extent(p + (-linear - root) / square, p + (root - linear) / square);
}

// Where a point in front of the near plane appears.
fn plane_place(point: vec3<f32>) -> vec2<f32> {
    if eye.perspective == 0u {
        return point.xy;
    }
    return point.xy / (eye.anchor_depth + point.z);
}

// A corner of the box around the prism: bit 0 for u, bit 1 for v, bit 2 for the height.
fn box_corner(n: u32, center: vec3<f32>, u: vec3<f32>, v: vec3<f32>, k: vec3<f32>, heights: vec2<f32>) -> vec3<f32> {
    let sides = select(vec2<f32>(-1.0), vec2<f32>(1.0), vec2<bool>((n & 1u) != 0u, (n & 2u) != 0u));
    return center + sides.x * u + sides.y * v + select(heights.x, heights.y, (n & 4u) != 0u) * k;
}

// The bound of the prism over an ellipse between two heights.
fn bound(center: vec3<f32>, u: vec3<f32>, v: vec3<f32>, k: vec3<f32>, heights: vec2<f32>) -> Bound {
    let low = center + heights.x * k;
    let high = center + heights.y * k;
    let spread = length(vec2<f32>(u.z, v.z));
    if min(low.z, high.z) - spread > eye.near {
        var extent = ellipse_extent(low, u, v, spread);
//#if QUADRIC
        extent = join(extent, ellipse_extent(high, u, v, spread));
//#end
        return to_samples(extent);
    }
    // The box's twelve edges: each corner with its neighbour in a direction it lacks.
    var extent = Extent(vec2<f32>(FAR), vec2<f32>(-FAR));
    for (var n = 0u; n < 8u; n++) {
        for (var bit = 1u; bit < 8u; bit = bit << 1u) {
            if (n & bit) == 0u {
                let a = box_corner(n, center, u, v, k, heights);
                let b = box_corner(n | bit, center, u, v, k, heights);
                extent = join(extent, edge_extent(a, b));
            }
        }
    }
    if extent.low.x > extent.high.x {
        return Bound(vec2<f32>(0.0), vec2<f32>(0.0), false);
    }
    return to_samples(extent);
}

// Beyond any place of a picture's plane.
const FAR: f32 = 1e30;

// Extent of what lies of an edge in front of the near plane.
fn edge_extent(a: vec3<f32>, b: vec3<f32>) -> Extent {
    var extent = Extent(vec2<f32>(FAR), vec2<f32>(-FAR));
    let da = a.z - eye.near;
    let db = b.z - eye.near;
    if da >= 0.0 {
        extent = join(extent, Extent(plane_place(a), plane_place(a)));
    }
    if db >= 0.0 {
        extent = join(extent, Extent(plane_place(b), plane_place(b)));
    }
    if (da < 0.0) != (db < 0.0) {
        let crossing = plane_place(vec3<f32>(a.xy + (b.xy - a.xy) * (da / (da - db)), eye.near));
        extent = join(extent, Extent(crossing, crossing));
    }
    return extent;
}

fn to_samples(extent: Extent) -> Bound {
    let flip = vec2<f32>(1.0, -1.0) / eye.unit;
    let a = eye.middle + extent.low * flip;
    let b = eye.middle + extent.high * flip;
    return Bound(min(a, b) - BOUND_PAD, max(a, b) + BOUND_PAD, true);
}
