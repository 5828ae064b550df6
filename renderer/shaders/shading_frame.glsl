#include "frame.glsl"

// The frame of a lobe about n: along the tangent where it has a direction, else any.
#ifdef ANISOTROPIC
vec3 here_tangent; // perpendicular to n; set before shading

mat3 shading_frame(vec3 n) {
    return mat3(here_tangent, cross(n, here_tangent), n);
}
#else
mat3 shading_frame(vec3 n) {
    return tangent_frame(n);
}
#endif
