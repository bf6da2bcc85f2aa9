// From a pixel's surface to its colour; twin of `shade.rs`. Pass 3, over the whole picture.

@group(1) @binding(0) var surfaces: texture_2d<f32>;
@group(1) @binding(1) var words: texture_2d<u32>;
@group(1) @binding(2) var normals: texture_2d<f32>;
//#if COLORED
@group(1) @binding(3) var colors: texture_2d<f32>;
//#end

// One triangle that holds the whole picture.
@vertex
fn whole(@builtin(vertex_index) n: u32) -> @builtin(position) vec4<f32> {
    return vec4<f32>(select(-1.0, 3.0, n == 1u), select(-1.0, 3.0, n == 2u), 0.0, 1.0);
}

// Lambert's diffuse and Blinn's specular reflection, linear.
fn lit(base: vec3<f32>, normal: vec3<f32>, direction: vec3<f32>) -> vec3<f32> {
    let cosine = max((dot(normal, eye.light) + eye.wrap) / (1.0 + eye.wrap), 0.0);
    let half = normalize(eye.light - normalize(direction));
    let highlight = pow(max(dot(normal, half), 0.0), eye.shininess);
    return base * (eye.ambient + eye.diffuse * cosine) + eye.specular * highlight;
}

// A stable linear colour for an index.
fn index_color(index: u32) -> vec3<f32> {
    let state = index * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    let hash = (word >> 22u) ^ word;
    let bytes = vec3<u32>(hash, hash >> 8u, hash >> 16u) & vec3<u32>(255u);
    return 0.08 + 0.72 * vec3<f32>(bytes) / 255.0;
}

// Linear light to sRGB.
fn encode(linear: vec3<f32>) -> vec3<f32> {
    let value = clamp(linear, vec3<f32>(0.0), vec3<f32>(1.0));
    return select(1.055 * pow(value, vec3<f32>(1.0 / 2.4)) - 0.055, 12.92 * value, value <= vec3<f32>(0.0031308));
}

@fragment
fn shade(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let place = vec2<u32>(position.xy);
    let word = textureLoad(words, place, 0).x;
    if word == 0u {
        return eye.background;
    }
    let direction = vec3<f32>(ray_through(position.xy).slope, 1.0);
    let surface = textureLoad(surfaces, place, 0);
    let depth = surface.w;
    let sums = textureLoad(normals, place, 0);
    // Rounding may differ between the passes, so that a hit at the very rim has no sums.
    let blended = sums.w > 0.0;
    let normal = normalize(select(surface.xyz, sums.xyz, blended));
    switch eye.show {
        case SHOW_NORMALS: {
            return vec4<f32>(0.5 * turn_back(normal) + 0.5 + NORMAL_TIE, 1.0);
        }
        case SHOW_DEPTH: {
            let along = clamp((depth - eye.grey_range.x) / (eye.grey_range.y - eye.grey_range.x), 0.0, 1.0);
            return vec4<f32>(vec3<f32>(mix(DEPTH_GREY_NEAR, DEPTH_GREY_FAR, along)), 1.0);
        }
        case SHOW_SPLATS: {
            return vec4<f32>(encode(lit(index_color((word - 1u) & INDEX_MASK), normal, direction)), 1.0);
        }
        case SHOW_KINDS: {
            var tints = TINTS;
            return vec4<f32>(encode(lit(tints[(word - 1u) >> INDEX_BITS], normal, direction)), 1.0);
        }
        default: {
//#if COLORED
            let base = select(MATTE, textureLoad(colors, place, 0).xyz / max(sums.w, RIM_WEIGHT), blended);
//#else
            let base = MATTE;
//#end
            return vec4<f32>(encode(lit(base, normal, direction)), 1.0);
        }
    }
}
