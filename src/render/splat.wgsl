// One splat, from its record to its fragments; twin of `splat.rs`.

struct Record {
    @location(0) center_high: vec3<f32>,
    @location(1) center_low: vec3<f32>,
    @location(2) i: vec3<f32>,
    @location(3) j: vec3<f32>,
    // r_u, r_v, a, b
    @location(4) shape: vec4<f32>,
    @location(5) color: vec3<f32>,
    // index and colour by kind, first conic, number of conics
    @location(6) words: vec3<u32>,
//#if PARTNERED
    // first partner, number of partners
    @location(7) partners: vec2<u32>,
//#end
}

// The splat in view coordinates, the same for all its fragments.
struct Cap {
    @builtin(position) position: vec4<f32>,
    // and the bounding radius
    @location(0) @interpolate(flat) center: vec4<f32>,
    @location(1) @interpolate(flat) i: vec3<f32>,
    @location(2) @interpolate(flat) j: vec3<f32>,
    @location(3) @interpolate(flat) k: vec3<f32>,
    @location(4) @interpolate(flat) shape: vec4<f32>,
    @location(5) @interpolate(flat) words: vec3<u32>,
//#if COLORED
    @location(6) @interpolate(flat) color: vec3<f32>,
//#end
//#if PARTNERED
    @location(7) @interpolate(flat) partners: vec2<u32>,
//#end
}

// Above the rounding of 32 bits between a splat's numbers and its rim.
const REACH_MARGIN: f32 = 1.0001;

// A rectangle sized by the splat's bound: corners 0 to 3 of a triangle strip.
@vertex
fn vertex(record: Record, @builtin(vertex_index) corner: u32) -> Cap {
    var cap: Cap;
    let center = to_view(record.center_high, record.center_low);
    cap.i = turn(record.i);
    cap.j = turn(record.j);
    cap.k = turn(cross(record.i, record.j));
    cap.shape = record.shape;
    cap.words = record.words;
//#if COLORED
    cap.color = record.color;
//#end
//#if PARTNERED
    cap.partners = record.partners;
//#end
    let radii = record.shape.xy;
//#if QUADRIC
    let sagitta = record.shape.zw * radii * radii;
    let heights = vec2<f32>(min(min(sagitta.x, sagitta.y), 0.0), max(max(sagitta.x, sagitta.y), 0.0));
//#else
    let heights = vec2<f32>(0.0);
//#end
    let tallest = max(heights.y, -heights.x);
    cap.center = vec4<f32>(center, length(vec2<f32>(max(radii.x, radii.y), tallest)) * REACH_MARGIN);
    let shown = bound(center, radii.x * cap.i, radii.y * cap.j, cap.k, heights);
    // Outside the clip volume when nothing of it shows.
    cap.position = vec4<f32>(2.0, 2.0, 0.0, 1.0);
    if shown.shown {
        let size = 2.0 * eye.middle;
        let low = clamp(shown.low, vec2<f32>(0.0), size);
        let high = clamp(shown.high, vec2<f32>(0.0), size);
        let place = select(low, high, vec2<bool>((corner & 1u) != 0u, (corner & 2u) != 0u));
        let ndc = (place / eye.middle - 1.0) * vec2<f32>(1.0, -1.0);
        cap.position = vec4<f32>(ndc, 0.0, 1.0);
    }
    return cap;
}

struct Hit {
    found: bool,
    depth: f32,
    uv: vec2<f32>,
    ellipse: f32,
}

fn to_local(cap: Cap, direction: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(dot(cap.i, direction), dot(cap.j, direction), dot(cap.k, direction));
}

// The place at a ray's parameter, if the splat is there.
fn covered(cap: Cap, ray: LocalRay, s: f32) -> Hit {
    let uv = (ray.origin + s * ray.direction).xy;
    let unit = uv / cap.shape.xy;
    var hit = Hit(false, cap.center.z + s, uv, dot(unit, unit));
    hit.found = s <= cap.center.w && hit.depth >= eye.near && hit.ellipse <= 1.0;
//#if CLIPPED
    if hit.found {
        hit.found = !clipped_away(cap.words.y, cap.words.z, unit);
    }
//#end
//#if PARTNERED
    if hit.found {
        hit.found = !partners_cut(cap.partners.x, cap.partners.y, ray.origin + s * ray.direction);
    }
//#end
    return hit;
}

// The nearest hit in front of the near plane.
fn hit(cap: Cap, ray: Ray) -> Hit {
    let lateral = ray_at(ray, cap.center.z) - cap.center.xy;
    let local = LocalRay(to_local(cap, vec3<f32>(lateral, 0.0)), to_local(cap, vec3<f32>(ray.slope, 1.0)));
//#if QUADRIC
    let s = roots(cap.shape.zw, local, cap.center.w);
    let first = covered(cap, local, s.x);
    if first.found {
        return first;
    }
    return covered(cap, local, s.y);
//#else
    return covered(cap, local, root(local, cap.center.w));
//#end
}

// The unit normal at a hit.
fn normal_at(cap: Cap, uv: vec2<f32>) -> vec3<f32> {
//#if QUADRIC
    let slope = -2.0 * cap.shape.zw * uv;
    return normalize(cap.i * slope.x + cap.j * slope.y + cap.k);
//#else
    return cap.k;
//#end
}

// By how many widths a hit gives way to what lies deeper.
fn gives_way(cap: Cap, hit: Hit, outward: vec3<f32>, direction: vec3<f32>) -> f32 {
//#if CLIPPED
    let distance = clearance(cap.words.y, cap.words.z, hit.uv / cap.shape.xy, cap.shape.xy);
    return yielded(distance, outward, direction);
//#else
    return 0.0;
//#end
}

struct Visible {
    @builtin(frag_depth) depth: f32,
    // Normal and depth. The normal is longer than one unit by the widths by which it gives way.
    @location(0) surface: vec4<f32>,
    // Index and colour by kind, plus 1 so that 0 is nothing.
    @location(1) word: u32,
}

// Pass 1: the nearest hit.
@fragment
fn visibility(cap: Cap) -> Visible {
    let ray = ray_through(cap.position.xy);
    let hit = hit(cap, ray);
    if !hit.found {
        discard;
    }
    let direction = vec3<f32>(ray.slope, 1.0);
    let outward = normal_at(cap, hit.uv);
    let widths = gives_way(cap, hit, outward, direction);
    let order = hit.depth + YIELD_SHARE * eye.band * widths;
    let along = (order - eye.depth_range.x) / (eye.depth_range.y - eye.depth_range.x);
    let surface = vec4<f32>((1.0 + widths) * face(outward, direction), hit.depth);
    return Visible(along, surface, cap.words.x + 1u);
}

@group(1) @binding(0) var surfaces: texture_2d<f32>;

struct Sums {
    // Weighted normal, and the weight.
    @location(0) normal: vec4<f32>,
//#if COLORED
    @location(1) color: vec4<f32>,
//#end
}

// Above what the length of a normal is rounded by.
const WIDTHS_ROUNDING: f32 = 1e-5;

// The hit of a splat that belongs to the visible surface: within the band behind the nearest
// hit, facing the same way, and on the same side of lines.
struct Part {
    found: bool,
    ellipse: f32,
    normal: vec3<f32>,
}

fn part(cap: Cap) -> Part {
    let ray = ray_through(cap.position.xy);
    let surface = textureLoad(surfaces, vec2<u32>(cap.position.xy), 0);
    let widths = length(surface.xyz) - 1.0;
    let visible = normalize(surface.xyz);
    let hit = hit(cap, ray);
    let direction = vec3<f32>(ray.slope, 1.0);
    let band = depth_band(visible, direction);
    if !hit.found || hit.depth > surface.w + band {
        return Part(false, 0.0, vec3<f32>(0.0));
    }
    let outward = normal_at(cap, hit.uv);
    // What gives way by more is of the other side of an edge, or of this one and no better.
    if gives_way(cap, hit, outward, direction) > widths + WIDTHS_ROUNDING {
        return Part(false, 0.0, vec3<f32>(0.0));
    }
    let normal = face(outward, direction);
    return Part(dot(normal, visible) >= AGREE_COSINE, hit.ellipse, normal);
}

// Pass 2: the weighted sums over the visible surface.
@fragment
fn attributes(cap: Cap) -> Sums {
    let part = part(cap);
    if !part.found {
        discard;
    }
    let weight = weight(part.ellipse);
    var sums: Sums;
    sums.normal = vec4<f32>(weight * part.normal, weight);
//#if COLORED
    sums.color = vec4<f32>(weight * cap.color, weight);
//#end
    return sums;
}

struct Identity {
    // Half the ellipse's value: the least wins, and all are below the cleared depth.
    @builtin(frag_depth) order: f32,
    @location(0) word: u32,
}

// Only for pictures that show identities: of the visible surface's splats, the one seen
// nearest its centre.
@fragment
fn identity(cap: Cap) -> Identity {
    let part = part(cap);
    if !part.found {
        discard;
    }
    return Identity(0.5 * part.ellipse, cap.words.x + 1u);
}
