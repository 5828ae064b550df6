// Schlick 1994, eq. 15.
vec3 F_schlick(vec3 f0, float cos_theta) {
    float m = clamp(1.0 - cos_theta, 0.0, 1.0), m2 = m * m;
    return f0 + (1.0 - f0) * (m2 * m2 * m);
}
