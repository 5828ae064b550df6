#include "eye_ray.glsl"
#include "corners.glsl"
#include "here_point.glsl"
#include "positions.glsl"

// Where in the scene a pixel's surface lies: its triangle, and the point on it that the pixel's
// centre shows.
uniform vec3 eye; // from the scene's middle, as `positions`

// Barycentric weights of where a ray meets the triangle's plane, Möller and Trumbore 1997.
vec3 plane_weights(uvec3 corner, vec3 ray) {
    vec3 a = position_of(corner.x), e1 = position_of(corner.y) - a, e2 = position_of(corner.z) - a;
    vec3 p = cross(ray, e2), s = eye - a, q = cross(s, e1);
    float volume = dot(e1, p);
    vec2 uv = volume != 0.0 ? vec2(dot(s, p), dot(ray, q)) / volume : vec2(1.0 / 3.0);
    return vec3(1.0 - uv.x - uv.y, uv);
}

// The same within the triangle: a centre just beside it is moved in.
vec3 weights_at(uvec3 corner, vec3 ray) {
    vec3 w = max(plane_weights(corner, ray), 0.0);
    return w / (w.x + w.y + w.z);
}
