#include "latlong.glsl"

// The environment with solid-angle-weighted mips. Its rows are aligned to the poles: row 0 is
// v = 0 and row H-1 is v = 1, while its columns lie at texel centres.
uniform sampler2D radiance_map;
uniform float environment_turn;

vec2 radiance_uv(vec3 world) {
    vec2 uv = latlong_from_direction(world, environment_turn);
    float rows = float(textureSize(radiance_map, 0).y);
    return vec2(uv.x, (uv.y * (rows - 1.0) + 0.5) / rows);
}

// Explicit level: implicit derivatives break at the poles and at the seam in azimuth.
vec3 radiance(vec3 world, float lod) {
    return textureLod(radiance_map, radiance_uv(world), lod).rgb;
}

// The level whose texel covers the solid angle of one of `count` samples of density `pdf`.
// Colbert and Krivanek 2007, GPU Gems 3 ch. 20, eq. 13, without their bias of one level.
float radiance_lod(vec3 world, float pdf, float count) {
    vec2 size = vec2(textureSize(radiance_map, 0));
    float sin_theta = max(length(world.xy), 0.5 / size.y);
    float texel = 2.0 * PI * PI / (size.x * max(size.y - 1.0, 1.0)) * sin_theta;
    return max(-0.5 * log2(max(count * pdf * texel, 1e-30)), 0.0);
}
