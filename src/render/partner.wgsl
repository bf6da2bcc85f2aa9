// What clip partners cut away; twin of `partner.rs`, which explains it.

struct Partner {
    // Rows of the map from the splat's coordinates to the partner's, the last with the sign that
    // is positive where it cuts.
    u: vec4<f32>,
    v: vec4<f32>,
    w: vec4<f32>,
    // a, b with that sign, outset, 1 for the last of a group
    shape: vec4<f32>,
}

@group(0) @binding(2) var<storage, read> partners: array<Partner>;

// Whether all partners of some group cut a place of the splat away.
fn partners_cut(first: u32, count: u32, place: vec3<f32>) -> bool {
    let at = vec4<f32>(place, 1.0);
    var together = true;
    for (var n = first; n < first + count; n++) {
        let partner = partners[n];
        let uv = vec2<f32>(dot(partner.u, at), dot(partner.v, at));
        together = together && dot(partner.w, at) - dot(partner.shape.xy * uv, uv) > partner.shape.z;
        if partner.shape.w != 0.0 {
            if together {
                return true;
            }
            together = true;
        }
    }
    return false;
}
