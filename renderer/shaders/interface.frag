#version 330
#include "hammersley.glsl"
#include "visible_ggx.glsl"
#include "beckmann_over_ggx.glsl"
#include "masking_smith.glsl"
#define G_GGX
#define G_BECKMANN
#include "masking_smith_mixture.glsl"
#include "fresnel_dielectric.glsl"
uniform float alpha;
uniform float eta;
uniform int first;
uniform int count;
uniform int points;
uniform float nodes;
layout(location = 0) out vec4 transmitted;

// The share of light from wo that passes a rough interface of GGX (r) and of Beckmann (g), each with
// its own Smith masking above and below: Walter et al. 2007, eq. 21, integrated over the half space
// below. Nodes and points
// as in directional_loss.frag.
void main() {
    float place = (gl_FragCoord.x - 0.5) / (nodes - 1.0);
    float y = place * place * place * place, z = max(y * (2.0 - y), 1e-6);
    vec3 wo = vec3((1.0 - y) * sqrt(1.0 + z), 0.0, z); // 1 - z is (1 - y)²
    vec2 both = vec2(0.0);
    const vec2 BECKMANN = vec2(0.0, 1.0);
    for (int i = first; i < first + count; ++i) {
        vec2 u = hammersley(uint(i), uint(points));
        u.y += 0.5 / float(points);
        float v = 1.0 - u.y, share = 3.0 * v * v; // more of the steepest: see directional_loss.frag
        vec3 h = visible_ggx(vec2(u.x, 1.0 - v * v * v), wo, alpha);
        float c = dot(wo, h);
        if (c <= 0.0 || h.z <= 0.0) continue;
        vec3 down = ((c - fresnel_inside(eta, c)) * h - wo) / eta; // refracted
        if (down.z >= 0.0) continue;
        float passed = share * one_minus_F_dielectric(eta, c);
        float ggx = G1_ggx(-down, alpha);
        float beckmann = G1_smith_mixture(wo, alpha, BECKMANN) * G1_smith_mixture(-down, alpha, BECKMANN)
            * beckmann_over_ggx(h, alpha) / G1_ggx(wo, alpha);
        both += passed * vec2(ggx, beckmann);
    }
    transmitted = vec4(both / float(count), 0.0, 1.0);
}
