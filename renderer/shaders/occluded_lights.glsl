#include "clear.glsl"
#include "sky.glsl"
#include "trace.glsl"
#ifdef LIGHTS
#include "light_bits.glsl"

// The first lights hold most of the light of all.
const int TRACED_LIGHTS = 2;

// How much of a light is seen: shadows of what is small are sharper than vertices tell.
float light_visibility(int light, vec3 world, bool faint) {
    if (faint || light >= TRACED_LIGHTS) return light_seen(light);
    return clear(world) || !blocked(here_point, world) ? 1.0 : 0.0;
}
#endif

uniform sampler2D vertex_irradiance; // of each vertex, of all but lights

// E(n) by what is baked at the vertices around, for the normals there; what arrives is its light.
vec3 even_irradiance(vec3 n) {
    vec3 E = vec3(0.0), there = vec3(0.0);
    for (int k = 0; k < AROUND; ++k) {
        ivec2 texel = row_texel(int(here_vertices[k]));
        E += here_weights[k] * texelFetch(vertex_irradiance, texel, 0).rgb;
        there += here_weights[k] * texelFetch(normals, texel, 0).xyz;
    }
    return corrected(E, sky_irradiance(n), sky_irradiance(normalize(there)));
}
