#include "radiance.glsl"

// The environment, blurred by a round kernel per level and without lights too small for it.
uniform sampler2D blurred_map;

// What arrives from a direction on average over a share of directions, as `incoming_lod` codes it.
vec3 incoming(vec3 wi_world, float lod) {
#ifdef NOTAP
    return wi_world*lod;
#endif
#ifdef NOATAN
 return textureLod(blurred_map, wi_world.xy, lod).rgb;
#endif
    return textureLod(blurred_map, radiance_uv(wi_world), lod).rgb;
}

// The level for one of the samples of a density that integrates to their number.
float incoming_lod(float density) {
    float texel = 2.0 * PI / float(textureSize(blurred_map, 0).x);
    return max(-0.5 * log2(max(density * texel * texel, 1e-30)), 0.0);
}
