#include "fresnel_schlick.glsl"

// F82-tint: Schlick less a term that falls to 0 at both ends, so that F is f82 where the cosine is
// 1/7. Lazanyi and Szirmay-Kalos 2005; by F82: Kutz et al. 2021, "Novel aspects of the Adobe
// Standard Material", section 2.3.
vec3 drop_f82(vec3 f0, vec3 f82, float cos_theta) {
    const float AT_82 = 1.0 / 7.0, M82 = 6.0 / 7.0;
    const float SCHLICK = M82 * M82 * M82 * M82 * M82; // of 1 - f0, that Schlick adds there
    float c = clamp(cos_theta, 0.0, 1.0), m = 1.0 - c, m2 = m * m;
    // f0 - f82 by itself: f0 + (1 - f0) SCHLICK, which is F there, becomes a mix() on some GPUs and
    // misses 1 where f0 is 1.
    vec3 drop = ((f0 - f82) + (1.0 - f0) * SCHLICK) / (AT_82 * M82 * SCHLICK);
    return drop * (c * m2 * m2 * m2);
}

// Where f0 and f82 are near 0 the term would take F below 0.
vec3 F_f82(vec3 f0, vec3 f82, float cos_theta) {
    return max(F_schlick(f0, cos_theta) - drop_f82(f0, f82, cos_theta), 0.0);
}

// A sum of what is not negative: nothing cancels.
vec3 one_minus_F_f82(vec3 f0, vec3 f82, float cos_theta) {
    return min(one_minus_F_schlick(f0, cos_theta) + drop_f82(f0, f82, cos_theta), 1.0);
}
