// Schlick 1994, eq. 15.
vec3 F_schlick(vec3 f0, float cos_theta) {
    float m = clamp(1.0 - cos_theta, 0.0, 1.0), m2 = m * m;
    return f0 + (1.0 - f0) * (m2 * m2 * m);
}

// 1 - F, which cancels where F nears 1; 1 - m^5 = (1 - m)(1 + m + m^2 + m^3 + m^4) does not.
vec3 one_minus_F_schlick(vec3 f0, float cos_theta) {
    float c = clamp(cos_theta, 0.0, 1.0), m = 1.0 - c;
    return (1.0 - f0) * (c * (1.0 + m * (1.0 + m * (1.0 + m * (1.0 + m)))));
}
