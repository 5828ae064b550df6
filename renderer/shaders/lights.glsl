#include "light_visibility.glsl"

// The lights taken out of the environment, in an environment that is not turned.
uniform sampler2D lights_map; // row 0: direction, level from which it is gone; row 1: irradiance

vec3 light_direction(int light, vec2 turn) {
    vec3 d = texelFetch(lights_map, ivec2(light, 0), 0).xyz;
    return vec3(turn.x * d.x - turn.y * d.y, turn.y * d.x + turn.x * d.y, d.z);
}

// What of it the environment does not show at a level: none below its own, all from there on.
float light_share(int light, float lod) {
    return clamp(lod - texelFetch(lights_map, ivec2(light, 0), 0).w + 1.0, 0.0, 1.0);
}
