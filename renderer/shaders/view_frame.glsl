// A tangent frame that turns with the view: v lies in the plane of x and z = n.
mat3 view_frame(vec3 n, vec3 v) {
    vec3 across = cross(n, v);
    // Seen head on, to a thousandth of a radian, any will do.
    if (dot(across, across) < 1e-6) across = cross(n, abs(n.z) < 0.9 ? vec3(0.0, 0.0, 1.0) : vec3(1.0, 0.0, 0.0));
    vec3 y = normalize(across);
    return mat3(cross(y, n), y, n);
}
