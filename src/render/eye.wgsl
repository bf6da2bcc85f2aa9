// The camera; twin of `eye.rs`. View coordinates are (right, up, forward), measured from the
// anchor: the point of the optical axis at the model's own depth, so that depths stay small
// however far away the eye is.

struct Eye {
    right: vec3<f32>,
    // One sample in units of the picture's plane.
    unit: f32,
    up: vec3<f32>,
    // The near plane's depth.
    near: f32,
    forward: vec3<f32>,
    // From the eye to the anchor.
    anchor_depth: f32,
    // The anchor in model units is the sum of both.
    anchor_high: vec3<f32>,
    perspective: u32,
    anchor_low: vec3<f32>,
    // Thickness of a surface along its normal.
    band: f32,
    middle: vec2<f32>,
    // Depths that the depth buffer's 0 and 1 stand for.
    depth_range: vec2<f32>,
    // Depths that the lightest and the darkest grey stand for.
    grey_range: vec2<f32>,
    show: u32,
    shininess: f32,
    light: vec3<f32>,
    ambient: f32,
    background: vec4<f32>,
    diffuse: f32,
    specular: f32,
    wrap: f32,
    // How near to a clip curve a place gives way.
    yielding: f32,
}

@group(0) @binding(0) var<uniform> eye: Eye;

struct Ray {
    offset: vec2<f32>,
    slope: vec2<f32>,
}

// The ray through a place of the picture, in samples from its upper left corner.
fn ray_through(place: vec2<f32>) -> Ray {
    let plane = (place - eye.middle) * vec2<f32>(eye.unit, -eye.unit);
    if eye.perspective != 0u {
        return Ray(vec2<f32>(0.0), plane);
    }
    return Ray(plane, vec2<f32>(0.0));
}

// The sideways place at a depth.
fn ray_at(ray: Ray, depth: f32) -> vec2<f32> {
    return ray.offset + (eye.anchor_depth + depth) * ray.slope;
}

// A direction of the model in view coordinates.
fn turn(direction: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(dot(eye.right, direction), dot(eye.up, direction), dot(eye.forward, direction));
}

// A direction of view coordinates in the model's.
fn turn_back(direction: vec3<f32>) -> vec3<f32> {
    return direction.x * eye.right + direction.y * eye.up + direction.z * eye.forward;
}

// A point, given as a sum, in view coordinates. The great parts cancel exactly.
fn to_view(high: vec3<f32>, low: vec3<f32>) -> vec3<f32> {
    return turn((high - eye.anchor_high) + (low - eye.anchor_low));
}
