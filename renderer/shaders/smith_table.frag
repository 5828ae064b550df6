#version 330
#include "hammersley.glsl"
#include "sample_ggx.glsl"
#include "beckmann_over_ggx.glsl"
#include "masking_smith_mixture.glsl"
in vec2 uv; // n.v
uniform float alpha;
uniform vec2 weight_d, weight_g;
uniform int count;
layout(location = 0) out vec4 scale_bias;

// Karis 2013, second sum, as in brdf_table.frag, for one material under masking `smith`.
void main() {
    vec3 wo = vec3(sqrt(1.0 - uv.x * uv.x), 0.0, uv.x);
    scale_bias = vec4(0.0);
    for (int i = 0; i < count; ++i) {
        vec3 h = sample_ggx(hammersley(uint(i), uint(count)), alpha);
        vec3 wi = reflect(-wo, h);
        float wo_h = dot(wo, h);
        if (wi.z <= 0.0 || wo_h <= 0.0) continue;
        float m = 1.0 - wo_h, fc = m * m * m * m * m;
        // D over D_ggx, which cancels against the density D_ggx h.z / (4 wo.h).
        float D = weight_d.x + weight_d.y * beckmann_over_ggx(h, alpha);
        float G = G_smith_mixture(wi, wo, alpha, weight_g);
        scale_bias.xy += vec2(1.0 - fc, fc) * (D * G * wo_h / (h.z * wo.z));
    }
    scale_bias /= float(count);
}
