#version 330
#include "hammersley.glsl"
#include "sample_ggx.glsl"
#include "beckmann_over_ggx.glsl"
#include "masking_smith.glsl"
#include "masking_vcavity.glsl"
in vec2 uv; // n.v and roughness
uniform int count;
layout(location = 0) out vec4 table; // scale and bias with G_smith, scale and bias with G_vcavity

// Karis 2013, second sum: integral of D G / (4 n.l n.v) n.l (1 - Fc) and Fc, by GGX samples.
void main() {
    float alpha = max(uv.y * uv.y, 1e-4);
    vec3 wo = vec3(sqrt(1.0 - uv.x * uv.x), 0.0, uv.x);
    table = vec4(0.0);
    for (int i = 0; i < count; ++i) {
        vec3 h = sample_ggx(hammersley(uint(i), uint(count)), alpha);
        vec3 wi = reflect(-wo, h);
        float wo_h = dot(wo, h);
        if (wi.z <= 0.0 || wo_h <= 0.0) continue;
        float m = 1.0 - wo_h, fc = m * m * m * m * m;
        vec2 G = vec2(G_smith(wi, wo, alpha), G_vcavity(wi, wo, h, wo_h));
        // D cancels against the density D h.z / (4 wo.h).
        vec4 term = (G * wo_h / (h.z * wo.z)).xxyy * vec4(1.0 - fc, fc, 1.0 - fc, fc);
#ifdef D_BECKMANN
        term *= beckmann_over_ggx(h, alpha);
#endif
        table += term;
    }
    table /= float(count);
}
