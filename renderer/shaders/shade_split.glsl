#include "diffuse_share.glsl"
#include "irradiance_exact.glsl"
#include "view_frame.glsl"

// Karis' split sum (2013) where the lobe really looks: each factor is exact, and the first is taken
// in the mean direction of the reflected light and at its spread, not around r = n = v. Lagarde and
// de Rousiers 2014 (4.9.3) fit that direction; here it is tabled with the second factor, per pair of
// a D and a G, so that it is as linear in the weights.
uniform float environment_turn;
uniform sampler2D lobe_ggx;         // rgb: sum of L n.l D, a: sum of n.l D; layer by layer in alpha
uniform sampler2D lobe_beckmann;
uniform sampler2D albedo_ggx;       // scale and bias with G_smith, with G_vcavity
uniform sampler2D albedo_beckmann;
uniform sampler2D towards_ggx;      // mean direction's x and z, times scale + bias, likewise
uniform sampler2D towards_beckmann;
#ifdef MASKING_SMITH
uniform sampler2D table_smith;      // scale and bias of this material
#endif
uniform float lobe_layers;

struct Reflected {
    vec2 scale_bias;
    vec2 towards; // mean direction in the plane of incidence, times scale + bias
};

Reflected tabled(float cos_theta, Material m) {
    vec2 uv = vec2(cos_theta, sqrt(m.alpha));
    vec4 albedo = vec4(0.0), towards = vec4(0.0);
#ifdef D_GGX
    albedo += m.weight_d.x * textureLod(albedo_ggx, uv, 0.0);
    towards += m.weight_d.x * textureLod(towards_ggx, uv, 0.0);
#endif
#ifdef D_BECKMANN
    albedo += m.weight_d.y * textureLod(albedo_beckmann, uv, 0.0);
    towards += m.weight_d.y * textureLod(towards_beckmann, uv, 0.0);
#endif
    return Reflected(m.weight_g.x * albedo.xy + m.weight_g.y * albedo.zw,
                     m.weight_g.x * towards.xy + m.weight_g.y * towards.zw);
}

// 1 - R: half the variance of directions whose mean has length R.
float spread(Reflected r) {
    return 1.0 - length(r.towards) / (r.scale_bias.x + r.scale_bias.y);
}

vec4 layered(sampler2D map, vec2 uv, float layer) {
    float edge = 0.5 * lobe_layers / float(textureSize(map, 0).y);
    float v = clamp(uv.y, edge, 1.0 - edge), low = min(floor(layer), lobe_layers - 2.0);
    return mix(textureLod(map, vec2(uv.x, (low + v) / lobe_layers), 0.0),
               textureLod(map, vec2(uv.x, (low + 1.0 + v) / lobe_layers), 0.0), layer - low);
}

// The light in a lobe around an axis, of the width alpha that it would have seen head on.
vec3 lobe_mean(vec3 axis, float alpha, Material m) {
    vec2 uv = latlong_from_direction(axis, environment_turn);
    float layer = clamp(2.0 * log2(alpha) + lobe_layers - 1.0, 0.0, lobe_layers - 1.0);
    vec4 sum = vec4(0.0);
#ifdef D_GGX
    sum += m.weight_d.x * layered(lobe_ggx, uv, layer);
#endif
#ifdef D_BECKMANN
    sum += m.weight_d.y * layered(lobe_beckmann, uv, layer);
#endif
    return sum.rgb / sum.a;
}

vec3 shade(vec3 n, vec3 v, Material m, int _set, int _sets) {
    float cos_theta = dot(n, v);
    Reflected seen = tabled(cos_theta, m), head_on = tabled(1.0, m);
    // Head on the spread goes with alpha²; the bounds are those of float32 and of the layers.
    float alpha = m.alpha * sqrt(clamp(spread(seen) / max(spread(head_on), 1e-7), 1.0 / 16.0, 16.0));
    vec3 axis = view_frame(n, v) * normalize(vec3(seen.towards.x, 0.0, seen.towards.y));
#ifdef MASKING_SMITH
    seen.scale_bias = textureLod(table_smith, vec2(cos_theta, 0.5), 0.0).xy;
#endif
    vec3 L = lobe_mean(axis, alpha, m) * (m.f0 * seen.scale_bias.x + seen.scale_bias.y);
#if defined(DIFFUSE) && !defined(SPECULAR_LIGHT)
    vec3 E = exact_irradiance(n, environment_turn);
    L += diffuse_share(m, cos_theta) * m.albedo * INV_PI * E;
#endif
    return L;
}
