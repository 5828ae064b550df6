#version 330
#define AT_VERTEX
#include "here.glsl"
#include "sky.glsl"
#ifdef LIGHTS
#include "light_bits.glsl"
#endif
// The environment's light on each vertex, through what is open of each coarse direction.
uniform sampler2D flux; // of each vertex and coarse direction, as transport/visibility.py has it
uniform sampler2D coarse_sky; // from each coarse direction
const float FLUX = 255.0 / 8160.0;
layout(location = 0) out vec4 all_of_it;
layout(location = 1) out vec4 beside_lights;

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    uint vertex = uint(texel.y * ROW + texel.x);
    vec3 n = texelFetch(normals, texel, 0).xyz, open = vec3(0.0), blocked = vec3(0.0);
    for (int coarse = 0; coarse < SEEN * SEEN; ++coarse) {
        vec2 through = texelFetch(flux, row_texel(int(vertex) * (SEEN * SEEN) + coarse), 0).xy;
        if (through.x + through.y == 0.0) continue;
        vec3 L = texelFetch(coarse_sky, ivec2(coarse, 0), 0).rgb;
        open += through.x * L;
        blocked += through.y * L;
    }
    vec3 E = PI * FLUX * open;
#ifdef DIFFUSE
    // So few looks err: by as much as they do under an open sky, whose light is known.
    E = corrected(E, sky_irradiance(n), E + PI * FLUX * blocked);
#endif
    beside_lights = vec4(E, 1.0);
#ifdef LIGHTS
    here_vertices[0] = vertex;
    here_weights = vec3(1.0, 0.0, 0.0);
    look_for_lights();
    for (int i = 0; i < light_count; ++i) {
        float cos_theta = max(dot(n, light_towards[i].xyz), 0.0);
        E += light_seen(i) * light_share(i, sky_lod()) * cos_theta * light_irradiance[i].rgb;
    }
#endif
    all_of_it = vec4(E, 1.0);
}
