#version 330
#include "radiance.glsl"
#include "frame.glsl"
#include "hammersley.glsl"
#include "ndf_ggx.glsl"
#include "sample_ggx.glsl"
in vec2 uv;
uniform float alpha;
uniform int count;
uniform vec2 size; // of the level that is made
layout(location = 0) out vec4 ggx;
layout(location = 1) out vec4 beckmann;

// Karis 2013: n = v = r, weighted by n.l. GGX samples serve both lobes (the paper, III.D): those
// of Beckmann carry D_beckmann / D_ggx, which depends on tan²/alpha² alone.
void main() {
    vec3 n = direction_from_latlong(uv, 0.0);
    mat3 to_world = tangent_frame(n);
    // No sample need see finer than the texels that it is stored in.
    float texels = size.x * size.y / (2.0 * PI * PI * max(length(n.xy), 0.5 / size.y));
    ggx = beckmann = vec4(0.0);
    for (int i = 0; i < count; ++i) {
        vec3 h = sample_ggx(hammersley(uint(i), uint(count)), alpha);
        vec3 wi = reflect(vec3(0.0, 0.0, -1.0), h);
        if (wi.z <= 0.0) continue;
        vec3 world = to_world * wi;
        float pdf = D_ggx(h, alpha) * 0.25; // D h.z / (4 wo.h) with wo = n
        float lod = radiance_lod(world, min(float(count) * pdf, texels), 1.0);
        vec4 term = wi.z * vec4(radiance(world, lod), 1.0);
        float t = dot(h.xy, h.xy) / (alpha * alpha * h.z * h.z);
        ggx += term;
        beckmann += term * exp(-t) * (1.0 + t) * (1.0 + t);
    }
    ggx /= float(count);
    beckmann /= float(count);
}
