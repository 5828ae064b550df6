#include "latlong.glsl"

// A lat-long map whose rows go from pole to pole, as those of the environment do: a level floor looks
// straight at one.
vec3 polar_map(sampler2D map, vec3 direction, float turn) {
    vec2 uv = latlong_from_direction(direction, turn);
    float rows = float(textureSize(map, 0).y);
    return textureLod(map, vec2(uv.x, (uv.y * (rows - 1.0) + 0.5) / rows), 0.0).rgb;
}
