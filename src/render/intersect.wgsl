// Where a ray meets a splat's quadric; twin of `intersect.rs`, which explains it.

// A ray in splat coordinates; its parameter is 0 at the centre's own depth.
struct LocalRay {
    origin: vec3<f32>,
    direction: vec3<f32>,
}

// No root: beyond any reach.
const NONE: f32 = 1e30;

fn quotient(numerator: f32, denominator: f32, reach: f32) -> f32 {
    if denominator != 0.0 && abs(numerator) <= reach * abs(denominator) {
        return numerator / denominator;
    }
    return NONE;
}

//#if QUADRIC
// Parameters, ascending, at which the ray meets w = a u² + b v².
fn roots(curvature: vec2<f32>, ray: LocalRay, reach: f32) -> vec2<f32> {
    let o = ray.origin;
    let r = ray.direction;
    let across = curvature * r.xy;
    let over = curvature * o.xy;
    let a = dot(across, r.xy);
    let b = 2.0 * dot(across, o.xy) - r.z;
    let c = dot(over, o.xy) - o.z;
    let discriminant = b * b - 4.0 * a * c;
    if discriminant >= 0.0 {
        let root = sqrt(discriminant);
        let q = -0.5 * select(b + root, b - root, b < 0.0);
        let s1 = quotient(q, a, reach);
        let s2 = quotient(c, q, reach);
        return vec2<f32>(min(s1, s2), max(s1, s2));
    }
    return vec2<f32>(NONE);
}
//#else
// The parameter at which the ray crosses the plane w = 0.
fn root(ray: LocalRay, reach: f32) -> f32 {
    return quotient(-ray.origin.z, ray.direction.z, reach);
}
//#end
