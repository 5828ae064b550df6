#include "brdf.glsl"
#include "incoming.glsl"
#include "sample_cosine.glsl"
#include "sample_visible_ggx.glsl"
#include "spiral.glsl"
#include "view_frame.glsl"
#ifdef ANISOTROPIC
#include "shading_frame.glsl"
#endif
#ifdef LIGHTS
#include "lights.glsl"
#endif

// The model's exact BRDF over a few fixed directions, each with the light blurred over its share of
// them (Krivanek and Colbert 2008), and over the lights that are too small for such a share. The
// balance heuristic (Veach and Guibas 1995) joins the lobes' samples, and the lights with them.
//
// One set of visible normals of GGX serves all mixtures: its density is nowhere small where
// Beckmann's is not, and a set per lobe would be coarser. The directions are the same in every pixel,
// turned with the plane of incidence, so that what they err is smooth and no noise.
uniform ivec3 pixel_samples; // GGX, Beckmann, cosine, where a pixel has one shading point
uniform ivec3 set_samples;   // and for each shading point where it has more
uniform float light_sharers; // how many such pixels make one of the picture

// Density of all samples together, per steradian; integrates to their number.
float filtered_density(vec3 wi, vec3 wo, Material m, ivec2 count) {
    vec3 h = normalize(wi + wo);
    float density = float(count.x) * pdf_visible_ggx(h, wo, m.alpha);
#ifdef COSINE
    density += float(count.y) * wi.z * INV_PI;
#endif
    return density;
}

vec3 filtered_sample(vec3 wi, vec3 wo, mat3 to_world, Material m, ivec2 count, float sharers) {
    if (wi.z <= 0.0) return vec3(0.0);
    float density = filtered_density(wi, wo, m, count);
    if (density <= 0.0) return vec3(0.0);
    return brdf(wi, wo, m) * wi.z / density * incoming(to_world * wi, incoming_lod(density * sharers));
}

#ifdef LIGHTS
vec3 lights(vec3 wo, mat3 to_world, Material m, ivec2 count, float sharers) {
    vec3 L = vec3(0.0);
    for (int i = 0; i < light_count; ++i) {
        vec3 world = light_towards[i].xyz, wi = world * to_world;
        if (wi.z <= 0.0) continue;
        float share = light_share(i, incoming_lod(filtered_density(wi, wo, m, count) * sharers));
        if (share <= 0.0) continue;
        L += share * light_visibility(i, world) * light_irradiance[i].rgb * brdf(wi, wo, m) * wi.z;
    }
    return L;
}
#endif

vec3 shade(vec3 n, vec3 v, Material m, int set, int sets) {
#ifdef ANISOTROPIC
    mat3 to_world = shading_frame(n);
#else
    mat3 to_world = view_frame(n, v);
#endif
    vec3 wo = v * to_world;
    ivec3 shares = sets == 1 ? pixel_samples : set_samples;
    ivec2 count = ivec2(shares.x + shares.y, shares.z);
    float sharers = light_sharers * float(sets);
    vec3 L = vec3(0.0);
    for (int i = 0; i < count.x; ++i) {
        vec3 h = sample_visible_ggx(spiral(i, count.x, set, sets), wo, m.alpha);
        L += filtered_sample(reflect(-wo, h), wo, to_world, m, count, sharers);
    }
#ifdef COSINE
    for (int i = 0; i < count.y; ++i) {
        vec3 wi = sample_cosine(spiral(i, count.y, set, sets));
        L += filtered_sample(wi, wo, to_world, m, count, sharers);
    }
#endif
#ifdef LIGHTS
    L += lights(wo, to_world, m, count, sharers);
#endif
    // Beside a bright edge the kernels' negative rims may outweigh the rest of a narrow lobe.
    return max(L, 0.0);
}
