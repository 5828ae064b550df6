#version 330
#include "here.glsl"
#ifdef LIGHTS
#include "lights.glsl"
#endif
// All that shines on each vertex: the environment through what is open of each coarse direction, and
// other surfaces' light through the rest.
uniform sampler2D normals;
uniform sampler2D flux; // of each vertex and coarse direction, as transport/visibility.py has it
const float FLUX = 255.0 / 2040.0;
layout(location = 0) out vec4 colour;

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    uint vertex = uint(texel.y * ROW + texel.x);
    vec3 n = texelFetch(normals, texel, 0).xyz, E = vec3(0.0);
    float lod = incoming_lod(float(SEEN * SEEN) * 0.25 * INV_PI);
    for (int coarse = 0; coarse < SEEN * SEEN; ++coarse) {
        vec2 through = texelFetch(flux, row_texel(int(vertex) * (SEEN * SEEN) + coarse), 0).xy;
        if (through.x > 0.0) E += through.x * environment(coarse_direction(coarse), lod);
        if (through.y > 0.0) E += through.y * sight_of(vertex, coarse);
    }
    E *= PI * FLUX;
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
