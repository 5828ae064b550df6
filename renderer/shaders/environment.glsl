#include "radiance.glsl"

// The environment, blurred by a round kernel per level and without lights too small for it:
// renderer/precompute/blurred.py.
uniform sampler2D blurred_map;

// What arrives on average over the share of directions that a sample stands for.
vec3 environment(vec3 world, float lod) {
    return textureLod(blurred_map, radiance_uv(world), lod).rgb;
}

// The level for one of the samples of a density that integrates to their number: level l is for
// shares of 4^l texels at the equator.
float incoming_lod(float density) {
    float texel = 2.0 * PI / float(textureSize(blurred_map, 0).x);
    return max(-0.5 * log2(max(density * texel * texel, 1e-30)), 0.0);
}

// The share of directions that a level is for.
float incoming_share(float lod) {
    float texel = 2.0 * PI / float(textureSize(blurred_map, 0).x);
    return texel * texel * exp2(2.0 * lod);
}
