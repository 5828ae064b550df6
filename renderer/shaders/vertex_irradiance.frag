#version 330
#include "here.glsl"
// All that shines on each vertex: the environment through what is open of each coarse direction,
// and other surfaces' light through the rest.
uniform sampler2D normals;
layout(location = 0) out vec4 colour;

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    uint vertex = uint(texel.y * ROW + texel.x);
    vec3 n = texelFetch(normals, texel, 0).xyz, E = vec3(0.0);
    float whole = 0.0;
    for (int coarse = 0; coarse < SEEN * SEEN; ++coarse) {
        vec3 d = coarse_direction(coarse);
        float weight = max(dot(n, d), 0.0) * octahedral_share(d);
        if (weight == 0.0) continue;
        float open = open_share(vertex, coarse);
        vec3 L = (1.0 - open) * sight_of(vertex, coarse);
        if (open > 0.0) L += open * radiance(d, radiance_lod(d, float(SEEN * SEEN) * 0.25 * INV_PI, 1.0));
        whole += weight;
        E += weight * L;
    }
    colour = vec4(whole > 0.0 ? PI * E / whole : vec3(0.0), 1.0);
}
