#include "density.glsl"
#include "radiance.glsl"
#include "picture.glsl"
#include "shading_frame.glsl"
#include "hammersley.glsl"
#include "sample_ggx.glsl"
#include "sample_beckmann.glsl"
#include "sample_cosine.glsl"
#ifdef ANISOTROPIC
#include "sample_anisotropic.glsl"
#endif

// The model's exact BRDF over sampled directions with filtered look-ups. Each lobe has its own
// share of the samples; the balance heuristic (Veach and Guibas 1995) joins them without bias.
uniform ivec3 pixel_samples; // GGX, Beckmann, cosine, where a pixel has one shading point
uniform ivec3 set_samples;   // and for each shading point where it has more
uniform float light_sharers; // how many such pixels make one of the picture; huge for no filter

vec3 incident(vec3 wi, vec3 wo, mat3 to_world, Material m, ivec3 count, float sharers) {
    if (wi.z <= 0.0) return vec3(0.0);
    float density = sample_density(wi, wo, m, count);
    if (density <= 0.0) return vec3(0.0);
    vec3 world = to_world * wi;
    return brdf(wi, wo, m) * wi.z / density * radiance(world, radiance_lod(world, density, sharers));
}

// Two fractions that differ from pixel to pixel: Jarzynski and Olano 2020, pcg3d.
vec2 pixel_shift() {
    uvec3 p = uvec3(picture_pixel(), 1u) * 1664525u + 1013904223u;
    p.x += p.y * p.z; p.y += p.z * p.x; p.z += p.x * p.y;
    p ^= p >> 16u;
    p.x += p.y * p.z; p.y += p.z * p.x;
    return vec2(p.xy >> 8u) * (1.0 / 16777216.0);
}

// Point i of the n that one of the pixel's sets has. Each set spans the lobe, for it may see what no
// other does; where they see alike, their points fall between one another's.
vec2 sample_point(int i, int n, int set, int sets, vec2 shift) {
    const float GOLDEN = 0.618033988749895; // the fraction whose multiples lie furthest apart
    vec2 between = vec2(float(set) / float(n * sets), GOLDEN * float(set));
    return fract(hammersley(uint(i), uint(n)) + between + shift);
}

vec3 shade(vec3 n, vec3 v, Material m, int set, int sets) {
    mat3 to_world = shading_frame(n);
    vec3 wo = v * to_world;
    vec2 shift = pixel_shift();
    // Split anew, not multiplied: of a set of one direction all but one lobe would get none.
    ivec3 count = sets == 1 ? pixel_samples : set_samples;
    float sharers = light_sharers * float(sets);
    vec3 L = vec3(0.0);
#ifdef D_GGX
    for (int i = 0; i < count.x; ++i) {
        vec2 u = sample_point(i, count.x, set, sets, shift);
        L += incident(reflect(-wo, sample_ggx(u, m.alpha)), wo, to_world, m, count, sharers);
    }
#endif
#ifdef D_BECKMANN
    for (int i = 0; i < count.y; ++i) {
        vec2 u = sample_point(i, count.y, set, sets, shift);
        L += incident(reflect(-wo, sample_beckmann(u, m.alpha)), wo, to_world, m, count, sharers);
    }
#endif
#ifdef COSINE
    for (int i = 0; i < count.z; ++i) {
        vec2 u = sample_point(i, count.z, set, sets, shift);
        L += incident(sample_cosine(u), wo, to_world, m, count, sharers);
    }
#endif
    return L;
}
