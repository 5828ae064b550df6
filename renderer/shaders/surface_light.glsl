#include "density.glsl"
#include "diffuse_share.glsl"
#include "frame.glsl"
#include "here.glsl"
#ifdef LIT_HITS
#include "light_bits.glsl"
#endif
#include "positions.glsl"
#include "hammersley.glsl"
#include "sample_ggx.glsl"
#include "sample_beckmann.glsl"
#ifdef ANISOTROPIC
#include "sample_anisotropic.glsl"
#endif

// What a surface sends to another one: coarsely, since it is seen through a reflection. With LIT_HITS
// lights are shaded apart from the environment, and each is seen or not; else they are blurred with it.
uniform sampler2D materials;  // of each object, as renderer/surface.py lays them out
uniform sampler2D irradiance; // of each vertex, of all that shines on it

Material material_of(int object) {
    vec4 a = texelFetch(materials, ivec2(0, object), 0), b = texelFetch(materials, ivec2(1, object), 0);
    vec4 c = texelFetch(materials, ivec2(2, object), 0);
    Material m;
    m.albedo = a.rgb;
    m.f0 = b.rgb;
    m.alpha = WIDTH(a.a);
    m.weight_d = vec2(b.a, 1.0 - b.a);
    m.weight_g = vec2(c.x, 1.0 - c.x);
#ifdef MAP_NORMAL
    m.facet_alpha = m.alpha;
    m.lean = vec2(0.0);
    m.upright = 1.0;
#endif
#ifdef FRESNEL_F82
    m.f82 = texelFetch(materials, ivec2(3, object), 0).rgb;
#endif
#if defined(FRESNEL_METAL) || defined(FRESNEL_DIELECTRIC)
    m.metallic = c.y;
    m.eta = c.z;
    m.metal_eta = texelFetch(materials, ivec2(4, object), 0).rgb;
    m.metal_k = texelFetch(materials, ivec2(5, object), 0).rgb;
#endif
#ifdef MULTISCATTER
    m.multiscatter = texelFetch(materials, ivec2(6, object), 0).rgb;
#endif
#ifdef LOST_LIGHT
    lost_row = (float(object) + 0.5) / float(textureSize(materials, 0).y);
#endif
    return m;
}

// Moves the few directions from one asker to the next, whose mean then errs less.
vec2 here_shift = vec2(0.0);

// Direction i of those that the lobes share out by `count`.
vec3 direction_of(vec3 wo, int i, ivec3 count, WIDTH alpha) {
    bool ggx = i < count.x;
    vec2 u = ggx ? hammersley(uint(i), uint(count.x)) : hammersley(uint(i - count.x), uint(count.y));
    u = fract(u + here_shift);
#if defined(D_GGX) && defined(D_BECKMANN)
    return reflect(-wo, ggx ? sample_ggx(u, alpha) : sample_beckmann(u, alpha));
#elif defined(D_GGX)
    return reflect(-wo, sample_ggx(u, alpha));
#else
    return reflect(-wo, sample_beckmann(u, alpha));
#endif
}

// What arrives from a direction, blurred over a sample's share of directions.
vec3 baked_light(vec3 world, float density) {
    float visibility = 0.0;
    vec3 L = baked_surfaces(world, visibility);
#ifdef LIT_HITS
    if (visibility > 0.0) L += visibility * environment(world, incoming_lod(density));
#else
    if (visibility > 0.0) L += visibility * radiance(world, radiance_lod(world, density, 1.0));
#endif
    return L;
}

const float COARSELY = 10.0; // so many times what matters to the eye directly matters here

// Towards v and the directions in a solid angle of `share` around it, from where the `here_`
// variables say, by `few` directions of the specular lobe. Of several observers each takes its own.
vec3 surface_light(vec3 v, int object, int few, int observer, int observers, float share, float t) {
    vec3 n = vec3(0.0), E = vec3(0.0);
    float curvature = 0.0;
    for (int k = 0; k < AROUND; ++k) {
        ivec2 texel = row_texel(int(here_vertices[k]));
        n += here_weights[k] * texelFetch(normals, texel, 0).xyz;
        curvature += here_weights[k] * texelFetch(positions, texel, 0).w;
        E += here_weights[k] * texelFetch(irradiance, texel, 0).rgb;
    }
    n = normalize(n);
    float cos_theta = dot(n, v);
    if (cos_theta <= 0.0) return vec3(0.0);
    // A bundle of rays fans out where a curved surface reflects it. Wider than a steradian, the lobe
    // that stands for it would lose too much below the horizon.
    float fan = 1.0 + 2.0 * curvature * t;
    share = min(share * fan * fan, 1.0);
    Material m = material_of(object);
    vec3 L = diffuse_share(m, cos_theta) * m.albedo * INV_PI * E;
    m.albedo = vec3(0.0);
    mat3 to_world = tangent_frame(n);
    vec3 wo = v * to_world;
    int all = few * observers;
    ivec3 count = ivec3(round(float(all) * m.weight_d), 0);
    count.y = all - count.x;
    vec3 specular = vec3(0.0);
    for (int i = observer; i < all; i += observers) {
        vec3 wi = direction_of(wo, i, count, m.alpha);
        if (wi.z <= 0.0) continue;
        float density = sample_density(wi, wo, m, count);
        if (density <= 0.0) continue;
        vec3 world = to_world * wi;
        specular += brdf(wi, wo, m) * wi.z / density * baked_light(world, 1.0 / (1.0 / density + share));
    }
#ifdef LIT_HITS
    Material wide = m;
    wide.alpha = sqrt(m.alpha * m.alpha + share / 24.0); // as in shade_filtered.glsl
    float else_sent = COARSELY * dot(L / float(observers) + specular, vec3(1.0 / 3.0));
    look_for_lights();
    int found = find_lights(wo, to_world, wide.alpha, 0.0, else_sent, observer, observers);
    for (int k = 0; k < found; ++k) {
        int i = found_lights[k];
        vec3 world = light_towards[i].xyz, wi = world * to_world;
        float density = sample_density(wi, wo, m, count);
        float part = light_share(i, incoming_lod(1.0 / (1.0 / density + share)));
        specular += part * light_seen(i) * light_irradiance[i].rgb * brdf(wi, wo, wide) * wi.z;
    }
#endif
    return L + float(observers) * specular;
}
