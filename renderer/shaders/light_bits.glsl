#include "here.glsl"
#include "lights.glsl"

// Which lights each vertex sees: vertex_lights.frag.
uniform usampler2D vertex_lights;
uvec4 here_lights[AROUND];

// To be called before `light_seen`, once the `here_` variables say where.
void look_for_lights() {
    for (int k = 0; k < AROUND; ++k) {
        here_lights[k] = texelFetch(vertex_lights, row_texel(int(here_vertices[k])), 0);
    }
}

// The share of the vertices around that see a light.
float light_seen(int light) {
    float seen = 0.0;
    for (int k = 0; k < AROUND; ++k) {
        uint bits = here_lights[k][light / PASS_LIGHTS];
        if ((bits >> uint(light % PASS_LIGHTS) & 1u) != 0u) seen += here_weights[k];
    }
    return seen;
}
