#include "material.glsl"
#include "fresnel_schlick.glsl"
#include "incoming.glsl"
#include "view_frame.glsl"

uniform sampler2D lobe_ggx;
uniform sampler2D lobe_beckmann;
uniform sampler2D albedo_ggx;
uniform sampler2D albedo_beckmann;
uniform sampler2D towards_ggx;
uniform sampler2D towards_beckmann;
uniform sampler2D irradiance_exact;
uniform float lobe_layers;

vec4 lobe_at(sampler2D map, vec2 uv, float layer) {
    float edge = 0.5 * lobe_layers / float(textureSize(map, 0).y);
    float v = clamp(uv.y, edge, 1.0 - edge);
    float low = min(floor(layer), lobe_layers - 2.0);
    vec4 a = textureLod(map, vec2(uv.x, (low + v) / lobe_layers), 0.0);
    vec4 b = textureLod(map, vec2(uv.x, (low + 1.0 + v) / lobe_layers), 0.0);
    return mix(a, b, layer - low);
}

// Scale and bias, and the mean direction times the share that it reflects.
void tabled(float cosine, Material m, out vec2 ab, out vec2 towards) {
    vec2 uv = vec2(cosine, sqrt(m.alpha));
    vec4 a = vec4(0.0), t = vec4(0.0);
#ifdef D_GGX
    a += m.weight_d.x * textureLod(albedo_ggx, uv, 0.0);
    t += m.weight_d.x * textureLod(towards_ggx, uv, 0.0);
#endif
#ifdef D_BECKMANN
    a += m.weight_d.y * textureLod(albedo_beckmann, uv, 0.0);
    t += m.weight_d.y * textureLod(towards_beckmann, uv, 0.0);
#endif
    ab = m.weight_g.x * a.xy + m.weight_g.y * a.zw;
    towards = m.weight_g.x * t.xy + m.weight_g.y * t.zw;
}

// 1 - mean of (1 - h.v)^5 over cosine-weighted directions: what Schlick's F takes from diffuse light,
// apart from F0. At most 2.8 %, at grazing angles, where F(n.v) would take all. A least squares
// fit of the double integral, within 8e-6.
float diffuse_share(float cosine) {
    float m = 1.0 - cosine;
    return 1.0 - (8.233e-5 + m * (2.022094e-3 + m * (9.309944e-3 + m * (7.797185e-3 + m * 8.951935e-3))));
}

vec3 shade(vec3 n, vec3 v, Material m, int _set, int _sets) {
    float cosine = dot(n, v);
    mat3 to_world = view_frame(n, v);
    vec2 ab, towards, ab_n, towards_n;
    tabled(cosine, m, ab, towards);
    tabled(1.0, m, ab_n, towards_n);
    // 1 - R is half the variance of directions whose mean has length R.
    float spread = 1.0 - length(towards) / (ab.x + ab.y), spread_n = 1.0 - length(towards_n) / (ab_n.x + ab_n.y);
    float alpha = m.alpha * sqrt(clamp(spread / max(spread_n, 1e-7), 0.04, 4.0));
    vec3 world = to_world * normalize(vec3(towards.x, 0.0, towards.y));
    vec2 uv = latlong_from_direction(world, environment_turn);
    float layer = clamp(log2(alpha) + lobe_layers - 1.0, 0.0, lobe_layers - 1.0);
    vec4 sum = vec4(0.0);
#ifdef D_GGX
    sum += m.weight_d.x * lobe_at(lobe_ggx, uv, layer);
#endif
#ifdef D_BECKMANN
    sum += m.weight_d.y * lobe_at(lobe_beckmann, uv, layer);
#endif
    vec3 L = sum.rgb / sum.a * (m.f0 * ab.x + ab.y);
#if defined(DIFFUSE) && !defined(SPECULAR_LIGHT)
    vec3 E = textureLod(irradiance_exact, latlong_from_direction(n, environment_turn), 0.0).rgb;
    L += diffuse_share(cosine) * (1.0 - m.f0) * m.albedo * INV_PI * E;
#endif
    return L;
}
