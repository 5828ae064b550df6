#include "brdf.glsl"
#include "incoming.glsl"
#include "sample_visible_ggx.glsl"
#include "sample_beckmann.glsl"
#include "sample_cosine.glsl"
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

float sample_density(vec3 wi, vec3 wo, Material m, ivec3 count) {
    float wo_h = 0.5 * length(wi + wo);
    vec3 h = (wi + wo) / (2.0 * wo_h);
    float density = 0.0;
#ifdef D_GGX
    density += float(count.x) * D_ggx(h, m.alpha) * G1_ggx(wo, m.alpha) / (4.0 * wo.z);
#endif
#ifdef D_BECKMANN
#ifdef BECK_GGX
    density += float(count.y) * D_ggx(h, BECK_GGX * m.alpha) * G1_ggx(wo, BECK_GGX * m.alpha) / (4.0 * wo.z);
#else
    density += float(count.y) * D_beckmann(h, m.alpha) * h.z / (4.0 * wo_h);
#endif
#endif
#ifdef DIFFUSE
    density += float(count.z) * wi.z * INV_PI;
#endif
    return density;
}

vec3 incident(vec3 wi, vec3 wo, mat3 to_world, Material m, ivec3 count, float sharers) {
    if (wi.z <= 0.0) return vec3(0.0);
    float density = sample_density(wi, wo, m, count);
    if (density <= 0.0) return vec3(0.0);
    return brdf(wi, wo, m) * wi.z / density * incoming(to_world * wi, incoming_lod(density * sharers));
}

vec2 sample_point(int i, int n, int set, int sets) {
    const float GOLDEN = 0.618033988749895;
    return vec2((float(i) + (float(set) + 0.5) / float(sets)) / float(n), fract(GOLDEN * float(i) + 0.381966 * float(set)+0.25));
}

vec3 shade(vec3 n, vec3 v, Material m, int set, int sets) {
    mat3 to_world = view_frame(n, v);
    vec3 wo = v * to_world;
    ivec3 count = sets == 1 ? pixel_samples : set_samples;
    float sharers = light_sharers * float(sets);
    vec3 L = vec3(0.0);
#ifdef D_GGX
    for (int i = 0; i < count.x; ++i) {
        vec3 h = sample_visible_ggx(sample_point(i, count.x, set, sets), wo, m.alpha);
        L += incident(reflect(-wo, h), wo, to_world, m, count, sharers);
    }
#endif
#ifdef D_BECKMANN
    for (int i = 0; i < count.y; ++i) {
#ifdef BECK_GGX
        vec3 h = sample_visible_ggx(sample_point(i, count.y, set, sets), wo, BECK_GGX * m.alpha);
#else
        vec3 h = sample_beckmann(sample_point(i, count.y, set, sets), m.alpha);
#endif
        L += incident(reflect(-wo, h), wo, to_world, m, count, sharers);
    }
#endif
#ifdef DIFFUSE
    for (int i = 0; i < count.z; ++i) {
        L += incident(sample_cosine(sample_point(i, count.z, set, sets)), wo, to_world, m, count, sharers);
    }
#endif
#ifdef LIGHTS
    float angle = -2.0 * PI * environment_turn;
    vec2 turn = vec2(cos(angle), -sin(angle));
    int lights = textureSize(lights_map, 0).x;
    for (int i = 0; i < lights; ++i) {
        vec3 world = light_direction(i, turn);
        vec3 wi = world * to_world;
        if (wi.z <= 0.0) continue;
        float share = light_share(i, incoming_lod(sample_density(wi, wo, m, count) * sharers));
        if (share <= 0.0) continue;
        vec3 E = texelFetch(lights_map, ivec2(i, 1), 0).rgb;
        L += brdf(wi, wo, m) * wi.z * share * light_visibility(i, world) * E;
    }
#endif
    return L;
}
