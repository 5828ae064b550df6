#include "common.glsl"
#include "width.glsl"

// Smith masking of a mixture of facets, separable: G1(wi) G1(wo) with 1 / G1 = sum v_j / G1_j.
// n.w / G1(w) is the projected area of the facets that w sees (Heitz 2014, eq. 14); it is linear in
// D, so the areas of the lobes add up, and G1 is their harmonic mean.

// Lambda of GGX, Heitz 2014, eq. 72; of Beckmann, eq. 68, for a = 1 / (alpha tan):
// (erf(a) - 1) / 2 + exp(-a²) / (2 a sqrt(pi)). GLSL has no erf. Abramowitz and Stegun 1964,
// 7.1.26, gives 1 - erf(a) as exp(-a²) times a polynomial, within 1.5e-7; it is added to 1, so the
// relative error of 1 / G1 = 1 + Lambda stays under 7.5e-8, that of a float.
float lambda_ggx(float tan_theta, float alpha) {
    float x = alpha * tan_theta;
    return 0.5 * (sqrt(1.0 + x * x) - 1.0);
}

float lambda_beckmann(float tan_theta, float alpha) {
    const float SQRT_PI = 1.77245385090552;
    float inverse_a = alpha * tan_theta;
    if (inverse_a < 0.1) return 0.0; // Lambda < exp(-100)
    float a = 1.0 / inverse_a;
    float t = 1.0 / (1.0 + 0.3275911 * a);
    float p = t * (0.254829592 + t * (-0.284496736 + t * (1.421413741 + t * (-1.453152027 + t * 1.061405429))));
    return 0.5 * exp(-a * a) * (inverse_a / SQRT_PI - p);
}

float G1_of_width(float tan_theta, float alpha, vec2 weight) {
    float lambda = 0.0;
#ifdef G_GGX
    lambda += weight.x * lambda_ggx(tan_theta, alpha);
#endif
#ifdef G_BECKMANN
    lambda += weight.y * lambda_beckmann(tan_theta, alpha);
#endif
    return 1.0 / (1.0 + lambda);
}

float G1_smith_mixture(vec3 w, WIDTH alpha, vec2 weight) {
    if (w.z <= 0.0) return 0.0;
#ifdef ANISOTROPIC
    return G1_of_width(wide_tan(w, alpha), 1.0, weight);
#else
    return G1_of_width(length(w.xy) / w.z, alpha, weight);
#endif
}

float G_smith_mixture(vec3 wi, vec3 wo, WIDTH alpha, vec2 weight) {
    return G1_smith_mixture(wi, alpha, weight) * G1_smith_mixture(wo, alpha, weight);
}
