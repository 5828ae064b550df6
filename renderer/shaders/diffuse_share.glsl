#include "brdf.glsl"

// The share of a surface's irradiance, over its albedo, that leaves towards a direction as diffuse
// light: what the model's kd makes of even light.
vec3 diffuse_share(Material m, float cos_theta) {
#if defined(KD_INTERFACE)
    return vec3(dot(lost_light_at(cos_theta).xy, m.weight_d)); // the factors' mean is 1
#elif defined(KD_CONSERVING)
    // The mean of the other factor: Gauss-Legendre over cosine squared.
    const vec3 COS = vec3(0.3357106870, 0.7071067812, 0.9419651451), SHARE = vec3(5.0, 8.0, 5.0) / 18.0;
    mat3 at = mat3(lost_light_at(COS.x).rgb, lost_light_at(COS.y).rgb, lost_light_at(COS.z).rgb);
    return lost_light_at(cos_theta).rgb * (at * SHARE);
#else
    // 1 - F(h.wi) averaged for Schlick's F: a least squares fit of the double integral, within 8e-6. At
    // most 2.8 %, at grazing angles, where F(n.v) would take all.
    float a = 1.0 - cos_theta;
    float taken = 8.233e-5 + a * (2.022094e-3 + a * (9.309944e-3 + a * (7.797185e-3 + a * 8.951935e-3)));
    return one_minus_fresnel(m, 1.0) * (1.0 - taken);
#endif
}
