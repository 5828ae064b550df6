#version 330
#include "hammersley.glsl"
#include "sample_ggx.glsl"
#include "visible_ggx.glsl"
#include "beckmann_over_ggx.glsl"
#include "mixture.glsl"
#include "fresnel.glsl"
#include "drawn_material.glsl"
uniform int first; // point of this pass
uniform int count; // of points in it
uniform int points; // in all passes, a power of 2
uniform float nodes; // along x
layout(location = 0) out vec4 lost;

// The share of even light that the specular lobe does not send back: rgb, and in a with F = 1. Row 1
// holds F itself. For the nodes' places see lost_light.glsl.
//
// What wo sees of facets adds up to 1 (Heitz 2014, eq. 80), and each sends back a part of what is
// seen of it. So the difference of both is summed, not the albedo: that of a smooth surface is all
// but 1. GGX's masking does not fit Beckmann's facets, and their sum is not 1: there 1 is.
void main() {
    Material m = drawn_material();
    float place = (gl_FragCoord.x - 0.5) / (nodes - 1.0);
    float y = place * place * place * place, z = max(y * (2.0 - y), 1e-6);
    if (gl_FragCoord.y > 1.0) {
        lost = vec4(fresnel(m, z), 1.0);
        return;
    }
    vec3 wo = vec3((1.0 - y) * sqrt(1.0 + z), 0.0, z); // 1 - z is (1 - y)²
    lost = vec4(0.0);
    for (int i = first; i < first + count; ++i) {
        vec2 u = hammersley(uint(i), uint(points));
        u.y += 0.5 / float(points); // its mean, too, is half
        // What GGX loses its steepest facets lose, at one end: they get more than their share, which
        // Beckmann has none of. Masked by cavities, the lobe is bounded over all normals; by Smith,
        // over those that wo sees.
        float v = 1.0 - u.y;
        vec2 rest = m.weight_d.x > 0.0 ? vec2(v * v * v, 3.0 * v * v) : vec2(v, 1.0);
#if defined(MASKING_SMITH) || defined(G_GGX)
        vec3 h = visible_ggx(vec2(u.x, 1.0 - rest.x), wo, m.alpha);
        float density = G1_ggx(wo, m.alpha) / rest.y; // wo.h / n.wo cancels below
#else
        vec3 h = sample_ggx(vec2(1.0 - rest.x, u.x), m.alpha);
        float density = h.z * wo.z / (dot(wo, h) * rest.y);
#endif
        float wo_h = dot(wo, h);
        bool faces = wo_h > 0.0 && h.z > 0.0;
        // D over D_ggx, which cancels against the density.
        float D = m.weight_d.x + m.weight_d.y * beckmann_over_ggx(h, m.alpha);
#if defined(MASKING_SMITH)
        float seen = faces ? D * G1_smith_mixture(wo, m.alpha, m.weight_g) / density : 0.0;
#elif defined(G_GGX)
        float seen = m.weight_d.y > 0.0 ? 1.0 : rest.y;
#else
        float seen = faces ? D * min(1.0, 2.0 * h.z * wo.z / wo_h) / density : 0.0;
#endif
        lost += seen;
        vec3 wi = reflect(-wo, h);
        if (wi.z <= 0.0 || !faces) continue;
        float G = G_mixture(wi, wo, h, wo_h, m.alpha, m.weight_g);
        lost -= vec4(fresnel(m, wo_h), 1.0) * (D * G / density);
    }
    lost /= float(count);
}
