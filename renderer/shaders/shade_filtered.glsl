#include "brdf.glsl"
#include "incoming.glsl"
#include "sample_visible_ggx.glsl"
#include "sample_cosine.glsl"
#include "picture.glsl"
#ifdef LIGHTS
#include "lights.glsl"
#endif

uniform ivec3 pixel_samples;
uniform ivec3 set_samples;
uniform float light_sharers;

mat3 view_frame(vec3 n, vec3 v) {
    vec3 across = cross(n, v);
    float l2 = dot(across, across);
    // Seen head on every frame is right.
    vec3 y = l2 > 1e-12 ? across * inversesqrt(l2) : normalize(cross(n, abs(n.z) < 0.9 ? vec3(0, 0, 1) : vec3(1, 0, 0)));
    return mat3(cross(y, n), y, n);
}

float sample_density(vec3 wi, vec3 wo, Material m, ivec2 count) {
    float wo_h = 0.5 * length(wi + wo);
    vec3 h = (wi + wo) / (2.0 * wo_h);
    vec3 hs = normalize(vec3(h.xy / m.alpha, h.z)), st = normalize(vec3(m.alpha * wo.xy, wo.z));
    float rest = (2.0 * dot(hs, st) * hs.z) / (1.0 + st.z);
#ifdef WARP
    float k = WARP;
    float tu = pow(max(rest, 1e-12), 1.0 / k - 1.0) / k;
#else
    float tu = inversesqrt(m.alpha * m.alpha + 4.0 * (1.0 - m.alpha) * max(rest, 1e-12));
#endif
    float density = tu * float(count.x) * D_ggx(h, m.alpha) * G1_ggx(wo, m.alpha) / (4.0 * wo.z);
#ifdef DIFFUSE
    density += float(count.y) * wi.z * INV_PI;
#endif
    return density;
}

vec3 incident(vec3 wi, vec3 wo, mat3 to_world, Material m, ivec2 count, float sharers) {
    if (wi.z <= 0.0) return vec3(0.0);
    float density = sample_density(wi, wo, m, count);
    if (density <= 0.0) return vec3(0.0);
    return brdf(wi, wo, m) * wi.z / density * incoming(to_world * wi, incoming_lod(density * sharers));
}

#ifdef INTER4
#define INTER (0.25 * float((int(picture_pixel().x) & 1) + 2 * (int(picture_pixel().y) & 1)))
#else
#define INTER 0.0
#endif
#ifndef PHASE
#define PHASE 0.25
#endif
vec2 sample_point(int i, int n, int set, int sets) {
    const float GOLDEN = 0.618033988749895;
    return vec2((float(i) + (float(set) + 0.5) / float(sets)) / float(n), fract(GOLDEN * float(i) + 0.381966 * float(set) + PHASE + INTER));
}

vec3 shade(vec3 n, vec3 v, Material m, int set, int sets) {
    mat3 to_world = view_frame(n, v);
    vec3 wo = v * to_world;
    ivec3 shares = sets == 1 ? pixel_samples : set_samples;
    ivec2 count = ivec2(shares.x + shares.y, shares.z);
    float sharers = light_sharers * float(sets);
    vec3 L = vec3(0.0);
    for (int i = 0; i < count.x; ++i) {
        vec2 u = sample_point(i, count.x, set, sets);
#ifdef WARP
        u.x = 1.0 - pow(1.0 - u.x, WARP);
#else
        u.x = 1.0 - (1.0 - u.x) * (m.alpha + (1.0 - m.alpha) * (1.0 - u.x));
#endif
        vec3 h = sample_visible_ggx(u, wo, m.alpha);
        L += incident(reflect(-wo, h), wo, to_world, m, count, sharers);
    }
#ifdef DIFFUSE
    for (int i = 0; i < count.y; ++i) {
        L += incident(sample_cosine(sample_point(i, count.y, set, sets)), wo, to_world, m, count, sharers);
    }
#endif
#if defined(LIGHTS) && !defined(NOLIGHTS)
    for (int i = 0; i < light_count; ++i) {
        vec3 world = light_towards[i].xyz;
        vec3 wi = world * to_world;
        if (wi.z <= 0.0) continue;
        float share = light_share(i, incoming_lod(sample_density(wi, wo, m, count) * sharers));
        if (share <= 0.0) continue;
        L += brdf(wi, wo, m) * wi.z * share * light_visibility(i, world) * light_irradiance[i].rgb;
    }
#endif
    return L;
}
