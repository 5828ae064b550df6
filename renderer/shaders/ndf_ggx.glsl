#include "common.glsl"

// Trowbridge and Reitz 1975; Walter et al. 2007, eq. 33, written with sin² taken from the
// components of h, since 1 - cos² cancels at small alpha.
float D_ggx(vec3 h, float alpha) {
    if (h.z <= 0.0) return 0.0;
    float t = dot(h.xy, h.xy) / (alpha * alpha) + h.z * h.z;
    return INV_PI / (alpha * alpha * t * t);
}
