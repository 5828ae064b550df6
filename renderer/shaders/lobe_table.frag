#version 330
#include "hammersley.glsl"
#include "sample_visible_ggx.glsl"
#include "beckmann_over_ggx.glsl"
#include "masking_vcavity.glsl"
in vec2 uv; // n.v and roughness
uniform int count;
layout(location = 0) out vec4 albedo; // scale and bias with G_smith, scale and bias with G_vcavity
layout(location = 1) out vec4 towards; // the sums of wi.x and wi.z, likewise

// The integral of D G / (4 n.l n.v) n.l (1 - Fc), that of Fc (Karis 2013, second sum), and of wi:
// where the lobe really looks, in the plane of incidence.
void main() {
    float alpha = max(uv.y * uv.y, 1e-4);
    vec3 wo = vec3(sqrt(1.0 - uv.x * uv.x), 0.0, uv.x);
    albedo = vec4(0.0);
    towards = vec4(0.0);
    for (int i = 0; i < count; ++i) {
        vec3 h = sample_visible_ggx(hammersley(uint(i), uint(count)), wo, alpha);
        vec3 wi = reflect(-wo, h);
        float wo_h = dot(wo, h);
        if (wi.z <= 0.0 || wo_h <= 0.0) continue;
        float m = 1.0 - wo_h, fc = m * m * m * m * m;
        vec2 G = vec2(G_smith(wi, wo, alpha), G_vcavity(wi, wo, h, wo_h));
        // D cancels against D_visible but for the masking of wo.
        G /= G1_ggx(wo, alpha) * tail_density(h, wo, alpha);
#ifdef D_BECKMANN
        G *= beckmann_over_ggx(h, alpha);
#endif
        albedo += G.xxyy * vec4(1.0 - fc, fc, 1.0 - fc, fc);
        towards += G.xxyy * wi.xzxz;
    }
    albedo /= float(count);
    towards /= float(count);
}
