#include "masking_smith.glsl"
#include "ndf_ggx.glsl"
#include "width.glsl"

// Directions of the facets of GGX that wo sees, by spherical caps: Dupuy and Benyoub 2023,
// "Sampling Visible GGX Normals with Spherical Caps", listing 3.
//
// Equal shares of them leave the long tail of GGX to a single sample: at 64 the last one stands for
// all directions more than 36 degrees off a lobe of alpha .04. So the share q of a lobe that lies
// beyond a direction is not r, the share of the samples, but alpha r + (1 - alpha) r²: as many more
// samples as the lobe is narrow. A wide one would send them below the horizon.

vec3 stretched(vec3 w, WIDTH alpha) {
    return normalize(vec3(alpha * w.xy, w.z));
}

// What stands for alpha there.
float tail(WIDTH alpha) {
#ifdef ANISOTROPIC
    return min(sqrt(alpha.x * alpha.y), 1.0);
#else
    return alpha;
#endif
}

// A half vector of density D_visible times `tail_density`. The cap's height z goes from 1 to -s.z;
// 1 - z and 1 + z are written out, for near the lobe's middle z would lose all but its first digits.
vec3 sample_visible_ggx(vec2 u, vec3 wo, WIDTH alpha) {
    float a = tail(alpha), r = max(1.0 - u.x, LEAST_REST), beyond = r * (a + (1.0 - a) * r);
    vec3 s = stretched(wo, alpha);
    float above = (1.0 + s.z) * u.x * (1.0 + (1.0 - a) * (1.0 - u.x)); // 1 - z
    float below = dot(s.xy, s.xy) / (1.0 + s.z) + (1.0 + s.z) * beyond; // 1 + z
    float aside = sqrt(max(above * below, 0.0)), phi = 2.0 * PI * u.y;
    return normalize(vec3(alpha * (aside * vec2(cos(phi), sin(phi)) + s.xy), (1.0 + s.z) * beyond));
}

// dr/dq: how much denser than D_visible the samples lie at h.
float tail_density(vec3 h, vec3 wo, WIDTH alpha) {
    vec3 s = stretched(wo, alpha), k = normalize(vec3(h.xy / alpha, h.z));
    float beyond = 2.0 * max(dot(s, k), 0.0) * max(k.z, 0.0) / (1.0 + s.z);
    float a = tail(alpha);
    return inversesqrt(a * a + 4.0 * (1.0 - a) * beyond);
}

// The density of the direction that a sampled h reflects to wo, per steradian.
float pdf_visible_ggx(vec3 h, vec3 wo, WIDTH alpha) {
    return tail_density(h, wo, alpha) * D_ggx(h, alpha) * G1_ggx(wo, alpha) / (4.0 * wo.z);
}
