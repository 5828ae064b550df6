#include "width.glsl"

// One object's material, as scenes.schema.Material resolves it, and what its model adds.
struct Material {
    vec3 albedo;   // of the diffuse lobe, already scaled by 1 - metallic
    vec3 f0;       // of the whole surface, mixed by metallic
    WIDTH alpha;   // roughness squared
    vec2 weight_d; // shares of GGX and Beckmann in D
    vec2 weight_g; // and of their maskings in G
#ifdef MAP_NORMAL
    WIDTH facet_alpha; // without the normals of a map, which make alpha wider where they are finer
    vec2 lean;         // than a pixel; their share of alpha² along and across
    float upright;     // the mean of their cosines to n
#endif
#ifdef FRESNEL_F82
    vec3 f82;      // reflectance where the cosine is 1/7, mixed by metallic
#endif
#if defined(FRESNEL_METAL) || defined(FRESNEL_DIELECTRIC)
    float metallic; // share of the metal in F
    float eta;      // of the dielectric
    vec3 metal_eta; // of the metal, n = eta + i k
    vec3 metal_k;
#endif
#ifdef MULTISCATTER
    vec3 multiscatter; // share of the light lost to a second facet that comes back
#endif
};
