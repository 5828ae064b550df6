#version 330
#include "radiance.glsl"
#include "frame.glsl"
#include "hammersley.glsl"
#include "ndf_ggx.glsl"
#include "sample_ggx.glsl"
#include "beckmann_over_ggx.glsl"
#ifdef D_GGX
#define AFTER_GGX 1
#else
#define AFTER_GGX 0
#endif
in vec2 uv;
uniform float alpha;
uniform int count;
uniform vec2 size; // of the level that is made
#ifdef D_GGX
layout(location = 0) out vec4 ggx;
#endif
#ifdef D_BECKMANN
layout(location = AFTER_GGX) out vec4 beckmann;
#endif

// Karis 2013: n = v = r, weighted by n.l. GGX samples serve both lobes (the paper, III.D).
void main() {
    vec3 n = direction_from_latlong(uv, 0.0);
    mat3 to_world = tangent_frame(n);
    // No sample need see finer than the texels that it is stored in.
    float texels = size.x * size.y / (2.0 * PI * PI * max(length(n.xy), 0.5 / size.y));
    vec4 sum_ggx = vec4(0.0), sum_beckmann = vec4(0.0);
    for (int i = 0; i < count; ++i) {
        vec3 h = sample_ggx(hammersley(uint(i), uint(count)), alpha);
        vec3 wi = reflect(vec3(0.0, 0.0, -1.0), h);
        if (wi.z <= 0.0) continue;
        vec3 world = to_world * wi;
        float pdf = D_ggx(h, alpha) * 0.25; // D h.z / (4 wo.h) with wo = n
        float lod = radiance_lod(world, min(float(count) * pdf, texels), 1.0);
        vec4 term = wi.z * vec4(radiance(world, lod), 1.0);
        sum_ggx += term;
        sum_beckmann += term * beckmann_over_ggx(h, alpha);
    }
#ifdef D_GGX
    ggx = sum_ggx / float(count);
#endif
#ifdef D_BECKMANN
    beckmann = sum_beckmann / float(count);
#endif
}
