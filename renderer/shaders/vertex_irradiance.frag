#version 330
#include "here.glsl"
#ifdef LIGHTS
#include "lights.glsl"
#endif
// All that shines on each vertex: the environment through what is open of each coarse direction,
// and other surfaces' light through the rest.
uniform sampler2D normals;
layout(location = 0) out vec4 colour;

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    uint vertex = uint(texel.y * ROW + texel.x);
    vec3 n = texelFetch(normals, texel, 0).xyz, E = vec3(0.0);
    float whole = 0.0, lod = incoming_lod(float(SEEN * SEEN) * 0.25 * INV_PI);
    for (int coarse = 0; coarse < SEEN * SEEN; ++coarse) {
        vec3 d = coarse_direction(coarse);
        float weight = max(dot(n, d), 0.0) * octahedral_share(d);
        if (weight == 0.0) continue;
        float open = open_share(vertex, coarse);
        vec3 L = (1.0 - open) * sight_of(vertex, coarse);
        if (open > 0.0) L += open * environment(d, lod);
        whole += weight;
        E += weight * L;
    }
    if (whole > 0.0) E *= PI / whole;
#ifdef LIGHTS
    for (int i = 0; i < light_count; ++i) {
        vec3 d = light_towards[i].xyz;
        float cos_theta = dot(n, d), share = light_share(i, lod);
        if (cos_theta <= 0.0 || share <= 0.0 || !bit(open_bits, vertex, octahedral_cell(d))) continue;
        E += share * cos_theta * light_irradiance[i].rgb;
    }
#endif
    colour = vec4(E, 1.0);
}
