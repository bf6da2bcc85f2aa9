// How the splats of a pixel come together; twin of `composite.rs`, which explains it.

// Weight of a hit by its squared distance from the centre in units of the ellipse.
fn weight(ellipse: f32) -> f32 {
    let inside = max(1.0 - ellipse, 0.0);
    return RIM_WEIGHT + (1.0 - RIM_WEIGHT) * inside * inside;
}

// How much deeper than the visible hit another of the same surface may lie.
fn depth_band(normal: vec3<f32>, direction: vec3<f32>) -> f32 {
    return eye.band / max(abs(dot(normal, direction)), COSINE_FLOOR * length(direction));
}

// How much deeper what lies across a line may be seen instead of a place so far from its curve: in the widths
// that `depth_yielded` of `composite.rs` is given.
fn yielded(distance: f32, outward: vec3<f32>, direction: vec3<f32>) -> f32 {
    let least = SINE_FLOOR * length(direction);
    let along = dot(outward, direction);
    let aside = length(direction - along * outward);
    let from_behind = select(0.0, 1.0, distance < YIELD_BEHIND * eye.yielding) / least;
    let from_above = max(1.0 - distance / eye.yielding, 0.0) / max(aside, least);
    return select(from_above, from_behind, along > 0.0);
}

// A normal turned towards the eye.
fn face(normal: vec3<f32>, direction: vec3<f32>) -> vec3<f32> {
    return select(normal, -normal, dot(normal, direction) > 0.0);
}
