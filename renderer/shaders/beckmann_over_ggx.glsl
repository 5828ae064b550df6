// D_beckmann / D_ggx, which depends on tan²/alpha² alone: by it GGX samples serve Beckmann too.
float beckmann_over_ggx(vec3 h, float alpha) {
    // At the horizon t is infinite, and exp(-t) t² no number; from 80 on it is below 1e-30.
    float t = min(dot(h.xy, h.xy) / (alpha * alpha * h.z * h.z), 80.0);
    return exp(-t) * (1.0 + t) * (1.0 + t);
}
