// D_beckmann / D_ggx, which depends on tan²/alpha² alone: by it GGX samples serve Beckmann too.
float beckmann_over_ggx(vec3 h, float alpha) {
    float t = dot(h.xy, h.xy) / (alpha * alpha * h.z * h.z);
    return exp(-t) * (1.0 + t) * (1.0 + t);
}
