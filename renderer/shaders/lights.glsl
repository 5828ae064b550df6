#include "common.glsl"
#include "width.glsl"

// The lights taken out of the environment: renderer/precompute/lights.py.
const int MOST_LIGHTS = 64; // as there
const int PASS_LIGHTS = 16; // a channel of vertex_lights.frag, as in renderer/transport/received.py
uniform int light_count;
uniform vec4 light_towards[MOST_LIGHTS];    // unit direction in the world; level from which it is gone
uniform vec4 light_irradiance[MOST_LIGHTS]; // RGB, of a surface that faces it

// What of it the environment does not show at a level: nothing one below its own, all from there on.
float light_share(int light, float lod) {
    return clamp(lod - light_towards[light].w + 1.0, 0.0, 1.0);
}

const float FAINT = 0.01; // of what else a surface sends: a light below it may be seen roughly

// The lights, from `first` on in steps of `stride`, of which a surface of some width may send more
// than FAINT² of what else it sends, grey. Found first and shaded then: processors that shade many
// pixels together run what they skip in a loop, but not turns that no pixel needs.
int found_lights[MOST_LIGHTS];

int find_lights(
    vec3 wo, mat3 to_world, WIDTH alpha, float diffuse, float else_sent, int first, int stride
) {
#ifdef ANISOTROPIC
    float a = max(alpha.x, alpha.y), a2 = a * a, peak = a2 / (alpha.x * alpha.y);
#else
    float a2 = alpha * alpha, peak = 1.0;
#endif
    int count = 0;
    float least = FAINT * FAINT * else_sent;
    for (int i = first; i < light_count; i += stride) {
        vec3 wi = light_towards[i].xyz * to_world, h = wi + wo;
        float irradiance = (light_irradiance[i].r + light_irradiance[i].g + light_irradiance[i].b) / 3.0;
        // F and G are at most 1, and D hardly above that of GGX.
        float d = dot(h, h), c = h.z * h.z * (a2 - 1.0) + d;
        float most = peak * a2 * d * d / (4.0 * PI * c * c * wo.z) + diffuse * wi.z;
        found_lights[count] = i;
        if (wi.z > 0.0 && irradiance * most > least) ++count;
    }
    return count;
}
