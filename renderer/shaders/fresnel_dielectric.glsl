// The Fresnel equations of a lossless interface seen from vacuum, unpolarised: Born and Wolf 1999,
// 7th ed., eq. 1.5.21. With w = sqrt(eta² - sin²), w² - c² = eta² - 1 exactly, so that
// r_s = (c - w) / (c + w) = -(eta² - 1) / (c + w)² does not cancel where eta is near 1.
float fresnel_inside(float eta, float c) {
    return sqrt(max(c * c + (eta - 1.0) * (eta + 1.0), 0.0));
}

float F_dielectric(float eta, float cos_theta) {
    float c = clamp(cos_theta, 0.0, 1.0), s2 = 1.0 - c * c;
    float w = fresnel_inside(eta, c);
    if (w == 0.0) return eta == 1.0 ? 0.0 : 1.0; // nothing there; total reflection
    float r_s = (eta - 1.0) * (eta + 1.0) / ((c + w) * (c + w));
    float p_s = (w * c - s2) / (w * c + s2); // r_p over r_s
    return 0.5 * r_s * r_s * (1.0 + p_s * p_s);
}

// 1 - F, which cancels where F nears 1, as the shares of both polarisations that go through.
float one_minus_F_dielectric(float eta, float cos_theta) {
    float c = clamp(cos_theta, 0.0, 1.0), eta2 = eta * eta;
    float w = fresnel_inside(eta, c);
    if (w == 0.0) return eta == 1.0 ? 1.0 : 0.0;
    float s = c + w, p = eta2 * c + w;
    return 2.0 * c * w * (1.0 / (s * s) + eta2 / (p * p));
}
