#include "common.glsl"

// Beckmann 1963; Walter et al. 2007, eq. 25. At h.z -> 0 exp wins over 1/z^4: the limit is 0.
float D_beckmann(vec3 h, float alpha) {
    float z2 = h.z * h.z;
    if (h.z <= 1e-6) return 0.0;
    return exp(-dot(h.xy, h.xy) / (alpha * alpha * z2)) * INV_PI / (alpha * alpha * z2 * z2);
}
