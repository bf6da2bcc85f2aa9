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

// How much deeper what lies across a line may be seen instead of a place on its curve.
fn depth_yielded(normal: vec3<f32>, direction: vec3<f32>) -> f32 {
    let aside = length(direction - dot(direction, normal) * normal);
    return YIELD_SHARE * eye.band / max(aside, SINE_FLOOR * length(direction));
}

// By which share of all that it may, a place so far from the nearest clip curve gives way.
fn yield_share(distance: f32, behind: bool) -> f32 {
    let from_behind = select(0.0, 1.0, distance < YIELD_BEHIND * eye.yielding);
    return select(max(1.0 - distance / eye.yielding, 0.0), from_behind, behind);
}

// A normal turned towards the eye.
fn face(normal: vec3<f32>, direction: vec3<f32>) -> vec3<f32> {
    return select(normal, -normal, dot(normal, direction) > 0.0);
}
