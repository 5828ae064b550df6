#include "material.glsl"
#include "fresnel_schlick.glsl"
#include "radiance.glsl"

// The paper's eq. 6 and 7: an irradiance map, and Karis' split sum (2013): a prefiltered
// environment times a table of scale and bias for F0.
uniform sampler2D irradiance_map;
uniform sampler2D prefiltered_ggx;      // rgb: sum of L n.l D/p, a: sum of n.l D/p
uniform sampler2D prefiltered_beckmann; // the same, over the same GGX samples
uniform sampler2D table_ggx;            // scale and bias for D_ggx with G_smith, with G_vcavity
uniform sampler2D table_beckmann;       // the same for D_beckmann
#ifdef MASKING_SMITH
uniform sampler2D table_smith;          // scale and bias of this material
#endif
uniform float prefilter_levels;

// Every quantity is linear in the weights, so one precomputation serves all of them; only the
// masking `smith` is not, and has a table for each material.
vec3 prefiltered(vec3 r, Material m) {
    vec2 uv = latlong_from_direction(r, environment_turn);
    float lod = sqrt(m.alpha) * (prefilter_levels - 1.0);
    vec4 sum = vec4(0.0);
#ifdef D_GGX
    sum += m.weight_d.x * textureLod(prefiltered_ggx, uv, lod);
#endif
#ifdef D_BECKMANN
    sum += m.weight_d.y * textureLod(prefiltered_beckmann, uv, lod);
#endif
    return sum.rgb / sum.a;
}

vec2 scale_bias(float cos_theta, Material m) {
#ifdef MASKING_SMITH
    return textureLod(table_smith, vec2(cos_theta, 0.5), 0.0).xy;
#else
    vec2 uv = vec2(cos_theta, sqrt(m.alpha));
    vec4 sum = vec4(0.0);
#ifdef D_GGX
    sum += m.weight_d.x * textureLod(table_ggx, uv, 0.0);
#endif
#ifdef D_BECKMANN
    sum += m.weight_d.y * textureLod(table_beckmann, uv, 0.0);
#endif
    return m.weight_g.x * sum.xy + m.weight_g.y * sum.zw;
#endif
}

vec3 shade(vec3 n, vec3 v, Material m, int _set, int _sets) {
    float cos_theta = dot(n, v);
    vec2 ab = scale_bias(cos_theta, m);
    vec3 L = prefiltered(reflect(-v, n), m) * (m.f0 * ab.x + ab.y);
#if defined(DIFFUSE) && !defined(SPECULAR_LIGHT)
    // The paper takes kd out of the integral, so F is known only at the view angle.
    vec3 kd = 1.0 - F_schlick(m.f0, cos_theta);
    vec2 uv = latlong_from_direction(n, environment_turn);
    L += kd * m.albedo * INV_PI * textureLod(irradiance_map, uv, 0.0).rgb;
#endif
    return L;
}
