#include "brdf.glsl"
#include "diffuse_share.glsl"
#include "even_light.glsl"
#include "incoming.glsl"
#include "mirror_share.glsl"
#include "sample_cosine.glsl"
#include "sample_visible_ggx.glsl"
#include "spiral.glsl"
#include "view_frame.glsl"
#ifdef ANISOTROPIC
#include "shading_frame.glsl"
#endif
#ifdef LIGHTS
#include "lights.glsl"
#include "light_visibility.glsl"
#endif

// The model's exact BRDF over a few fixed directions, each with the light blurred over its share of
// them (Krivanek and Colbert 2008), and over the lights that are too small for such a share. The
// balance heuristic (Veach and Guibas 1995) joins the lobes' samples, and the lights with them.
//
// One set of visible normals of GGX serves all mixtures: its density is nowhere small where
// Beckmann's is not, and a set per lobe would be coarser. The directions are the same in every pixel,
// turned with the plane of incidence, so that what they err is smooth and no noise.
//
// Of so few directions a diffuse lobe would still see a bright horizon too much or too little. So they
// only tell how far the lobe is off an even one, whose light E(n) is known: a control variate.
#if defined(DIFFUSE) && !defined(SPECULAR_LIGHT) && !defined(SAMPLED_DIFFUSE)
#define EVEN_LOBE
#endif
// Of each shading point where a pixel has 1, 4, 16 or 64 of them.
uniform ivec4 specular_samples;
uniform ivec4 cosine_samples;
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

// The level of the light for a sample of a density.
float sample_lod(float density, float sharers) {
    return incoming_lod(1.0 / (1.0 / (density * sharers) + mirror_share));
}

#ifdef EVEN_LOBE
vec3 even_lobe; // of the surface that is shaded

vec3 even_lobe_of(Material m, vec3 wo) {
    vec3 lobe = INV_PI * diffuse_share(m, wo.z) * m.albedo;
#if defined(MAP_NORMAL) && !defined(KD_INTERFACE) && !defined(KD_CONSERVING)
    lobe *= m.upright;
#endif
    return lobe;
}
#endif

vec3 filtered_sample(vec3 wi, vec3 wo, mat3 to_world, Material m, ivec2 count, float sharers) {
    if (wi.z <= 0.0) return vec3(0.0);
    float density = filtered_density(wi, wo, m, count);
    if (density <= 0.0) return vec3(0.0);
    vec3 world = to_world * wi;
    float lod = sample_lod(density, sharers);
    vec3 f = brdf(wi, wo, m);
#ifdef EVEN_LOBE
    f -= even_lobe;
#endif
    return wi.z / density * f * incoming(world, lod);
}

#ifdef LIGHTS
// `around` is what the environment gives: a light far dimmer than that may be seen roughly.
vec3 lights(
    vec3 wo, mat3 to_world, Material m, ivec2 count, float sharers, int set, int sets, vec3 around
) {
    vec3 L = vec3(0.0);
    Material wide = m;
    // The variance of normals per axis, a 48th of the solid angle that they mirror, on top of that
    // of facets, alpha² / 2: Kaplanyan et al. 2016, "Filtering Distributions of Normals".
    wide.alpha = sqrt(m.alpha * m.alpha + mirror_share / 24.0);
    int stride = max(sets / 16, 1); // 16 shading points of a pixel tell a light well enough
    float else_sent = (around.r + around.g + around.b) / (3.0 * float(stride));
#ifdef COSINE
    const float diffuse = INV_PI;
#else
    const float diffuse = 0.0;
#endif
    look_for_lights();
    int found = find_lights(wo, to_world, wide.alpha, diffuse, else_sent, set % stride, stride);
    for (int k = 0; k < found; ++k) {
        int i = found_lights[k];
        vec3 world = light_towards[i].xyz, wi = world * to_world;
        float share = light_share(i, sample_lod(filtered_density(wi, wo, m, count), sharers));
        vec3 arrives = wi.z * light_irradiance[i].rgb, sent = share * arrives * brdf(wi, wo, wide);
#ifdef EVEN_LOBE
        sent += (light_share(i, sky_lod()) - share) * arrives * even_lobe;
#endif
        bool faint = sent.r + sent.g + sent.b < 3.0 * FAINT * else_sent;
        L += sent * light_visibility(i, world, faint);
    }
    return float(stride) * L;
}
#endif

vec3 shade(vec3 n, vec3 v, Material m, int set, int sets) {
#ifdef ANISOTROPIC
    mat3 to_world = shading_frame(n);
#else
    mat3 to_world = view_frame(n, v);
#endif
    vec3 wo = v * to_world;
#ifdef EVEN_LOBE
    even_lobe = even_lobe_of(m, wo);
#endif
    int step = sets >= 64 ? 3 : sets >= 16 ? 2 : sets >= 4 ? 1 : 0;
    ivec2 count = ivec2(specular_samples[step], cosine_samples[step]);
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
#ifdef EVEN_LOBE
    L += even_lobe * even_irradiance(n);
#endif
#ifdef LIGHTS
    L += lights(wo, to_world, m, count, sharers, set, sets, L);
#endif
    // Beside a bright edge the kernels' negative rims may outweigh the rest of a narrow lobe.
    return max(L, 0.0);
}
