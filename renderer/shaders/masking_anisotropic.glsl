// Smith masking with the width along w's own azimuth, Heitz 2014, eq. 80 and 86.
float wide_tan(vec3 w, vec2 alpha) {
    return length(alpha * w.xy) / w.z;
}

float G1_ggx(vec3 w, vec2 alpha) {
    if (w.z <= 0.0) return 0.0;
    float t = wide_tan(w, alpha);
    return 2.0 / (1.0 + sqrt(1.0 + t * t));
}

float G_smith(vec3 wi, vec3 wo, vec2 alpha) {
    return G1_ggx(wi, alpha) * G1_ggx(wo, alpha);
}
