// The Fresnel equations of an absorbing interface seen from vacuum, unpolarised, of one channel:
// Born and Wolf 1999, 7th ed., section 14.2. With n = eta + i k and w = sqrt(n² - sin²),
// w² - c² = n² - 1 exactly, so that r_s = (c - w) / (c + w) = -(n² - 1) / (c + w)² does not cancel
// where n is near 1.
vec2 complex_root(vec2 z) {
    // The larger part by a sum, the other by division: a difference would cancel.
    float size = length(z), large = sqrt(0.5 * (size + abs(z.x)));
    if (large == 0.0) return vec2(0.0);
    float small = 0.5 * z.y / large;
    return z.x >= 0.0 ? vec2(large, small) : vec2(small, large);
}

// n² - 1 and w
vec4 fresnel_conductor_inside(float eta, float k, float c) {
    vec2 rest = vec2((eta - 1.0) * (eta + 1.0) - k * k, 2.0 * eta * k);
    return vec4(rest, complex_root(vec2(c * c + rest.x, rest.y)));
}

float F_conductor(float eta, float k, float cos_theta) {
    float c = clamp(cos_theta, 0.0, 1.0), s2 = 1.0 - c * c;
    vec4 inside = fresnel_conductor_inside(eta, k, c);
    vec2 w = inside.zw, sum = vec2(c + w.x, w.y);
    float sum2 = dot(sum, sum);
    if (sum2 == 0.0) return 0.0; // eta 1 and k 0, seen along the surface: nothing is there
    float R_s = dot(inside.xy, inside.xy) / (sum2 * sum2);
    // |r_p / r_s|²
    vec2 less = vec2(w.x * c - s2, w.y * c), more = vec2(w.x * c + s2, w.y * c);
    return 0.5 * R_s * (1.0 + dot(less, less) / dot(more, more));
}

// 1 - F, which cancels where F nears 1, as the shares of both polarisations that go through.
float one_minus_F_conductor(float eta, float k, float cos_theta) {
    float c = clamp(cos_theta, 0.0, 1.0);
    vec4 inside = fresnel_conductor_inside(eta, k, c);
    vec2 w = inside.zw, n2 = inside.xy + vec2(1.0, 0.0);
    vec2 s = vec2(c + w.x, w.y), p = n2 * c + w;
    if (dot(s, s) == 0.0) return 1.0;
    return 2.0 * c * (w.x / dot(s, s) + dot(n2, w) / dot(p, p));
}

vec3 F_conductor(vec3 eta, vec3 k, float cos_theta) {
    return vec3(
        F_conductor(eta.r, k.r, cos_theta),
        F_conductor(eta.g, k.g, cos_theta),
        F_conductor(eta.b, k.b, cos_theta)
    );
}

vec3 one_minus_F_conductor(vec3 eta, vec3 k, float cos_theta) {
    return vec3(
        one_minus_F_conductor(eta.r, k.r, cos_theta),
        one_minus_F_conductor(eta.g, k.g, cos_theta),
        one_minus_F_conductor(eta.b, k.b, cos_theta)
    );
}
