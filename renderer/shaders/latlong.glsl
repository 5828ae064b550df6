#include "common.glsl"

// Lat-long maps: column u at azimuth atan(x, y) = 2 pi u, row v at polar angle acos(z) = pi v.
// `turn` is the environment's rotation about z as a fraction of a full turn.
vec2 latlong_from_direction(vec3 world, float turn) {
    // At a pole every azimuth is right, but atan(0, 0) is undefined.
    float azimuth = world.xy == vec2(0.0) ? 0.0 : atan(world.x, world.y);
    float u = azimuth * (0.5 * INV_PI) + turn;
    // acos loses half its digits near the poles (and is coarse on some drivers); atan does not.
    float v = atan(length(world.xy), world.z) * INV_PI;
    return vec2(u, v);
}

vec3 direction_from_latlong(vec2 uv, float turn) {
    float phi = 2.0 * PI * (uv.x - turn), theta = PI * uv.y;
    return vec3(sin(phi) * sin(theta), cos(phi) * sin(theta), cos(theta));
}
