#version 330
#include "incoming.glsl"
#include "hammersley.glsl"
#include "frame.glsl"
#include "sample_visible_ggx.glsl"
#include "beckmann_over_ggx.glsl"
#include "lights.glsl"
in vec2 uv;
uniform float layers; // one below the other, each a whole lat-long map
uniform int count;
#ifdef D_GGX
#define AFTER_GGX 1
layout(location = 0) out vec4 ggx;
#else
#define AFTER_GGX 0
#endif
#ifdef D_BECKMANN
layout(location = AFTER_GGX) out vec4 beckmann;
#endif

const vec3 HEAD_ON = vec3(0.0, 0.0, 1.0); // n = v

// D(h) n.l / 4 of both lobes towards a direction: Karis 2013, as in prefilter.frag.
vec2 kernel(vec3 wi, float alpha) {
    vec3 h = normalize(wi + HEAD_ON);
    float D = D_ggx(h, alpha);
    return 0.25 * D * wi.z * vec2(1.0, beckmann_over_ggx(h, alpha));
}

// Karis' first sum for n = v = r, over filtered samples and over the lights.
void main() {
    // alpha = 1 in the last layer, and in each the root of 2 times the one before.
    float layer = floor(uv.y * layers), alpha = exp2((layer - layers + 1.0) * 0.5);
    mat3 to_world = tangent_frame(direction_from_latlong(vec2(uv.x, fract(uv.y * layers)), 0.0));
    vec4 sum_ggx = vec4(0.0), sum_beckmann = vec4(0.0);
    for (int i = 0; i < count; ++i) {
        vec3 h = sample_visible_ggx(hammersley(uint(i), uint(count)), HEAD_ON, alpha);
        vec3 wi = reflect(-HEAD_ON, h);
        if (wi.z <= 0.0) continue;
        float density = float(count) * pdf_visible_ggx(h, HEAD_ON, alpha);
        vec2 k = kernel(wi, alpha) / density;
        vec4 L = vec4(incoming(to_world * wi, incoming_lod(density)), 1.0);
        sum_ggx += k.x * L;
        sum_beckmann += k.y * L;
    }
    for (int i = 0; i < light_count; ++i) {
        vec3 wi = light_towards[i].xyz * to_world;
        if (wi.z <= 0.0) continue;
        vec3 h = normalize(wi + HEAD_ON);
        float share = light_share(i, incoming_lod(float(count) * pdf_visible_ggx(h, HEAD_ON, alpha)));
        vec2 k = share * kernel(wi, alpha);
        sum_ggx.rgb += k.x * light_irradiance[i].rgb;
        sum_beckmann.rgb += k.y * light_irradiance[i].rgb;
    }
#ifdef D_GGX
    ggx = sum_ggx;
#endif
#ifdef D_BECKMANN
    beckmann = sum_beckmann;
#endif
}
