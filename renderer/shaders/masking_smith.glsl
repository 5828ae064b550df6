// Smith masking of GGX, Walter et al. 2007, eq. 34, separable: G1(wi) G1(wo).
float G1_ggx(vec3 w, float alpha) {
    if (w.z <= 0.0) return 0.0;
    float tan2 = dot(w.xy, w.xy) / (w.z * w.z);
    return 2.0 / (1.0 + sqrt(1.0 + alpha * alpha * tan2));
}

float G_smith(vec3 wi, vec3 wo, float alpha) {
    return G1_ggx(wi, alpha) * G1_ggx(wo, alpha);
}
