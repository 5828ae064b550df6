#include "latlong.glsl"

// E(n) of the whole environment. Its rows go from pole to pole, as those of the environment do: a
// level floor looks straight at one.
uniform sampler2D irradiance_exact;

vec3 exact_irradiance(vec3 n, float turn) {
    vec2 uv = latlong_from_direction(n, turn);
    float rows = float(textureSize(irradiance_exact, 0).y);
    return textureLod(irradiance_exact, vec2(uv.x, (uv.y * (rows - 1.0) + 0.5) / rows), 0.0).rgb;
}
