#version 330
#include "radiance.glsl"
#include "frame.glsl"
in vec2 uv;
uniform int taps;
uniform float share; // the solid angle of samples that will read this level
layout(location = 0) out vec4 blurred;

// Variance over the share, an axis: kernels of samples that lie as evenly as can be then add up to
// something flat, within 1 %, while they blur little.
const float SPREAD = 0.25;

// Light around an axis under (2 - x) exp(-x), x = kappa (1 - cos): a lobe of von Mises and Fisher made
// sharper, so that its second moment vanishes (a Gaussian kernel of 4th order: Wand and Schucany
// 1990). A plain one would widen the lobe that is sampled by its own width.
void main() {
    float rows = float(textureSize(radiance_map, 0).y);
    float polar = clamp((uv.y * rows - 0.5) / max(rows - 1.0, 1.0), 0.0, 1.0);
    mat3 to_world = tangent_frame(direction_from_latlong(vec2(uv.x, polar), 0.0));
    float kappa = 1.0 / (SPREAD * share);
    float least = exp(-2.0 * kappa); // of the lobe, straight behind
    bool narrow = kappa > 2.0;        // wider ones are all of the sphere
    vec4 sum = vec4(0.0);
    for (int i = 0; i < taps; ++i) {
        float x = -log(1.0 - (float(i) + 0.5) / float(taps) * (1.0 - least));
        float z = 1.0 - x / kappa, aside = sqrt(max(1.0 - z * z, 0.0));
        float phi = 2.0 * PI * fract(0.618033988749895 * float(i));
        vec3 world = to_world * vec3(aside * cos(phi), aside * sin(phi), z);
        float pdf = kappa * exp(-x) / (2.0 * PI * (1.0 - least));
        float lod = radiance_lod(world, pdf, float(taps));
        sum += (narrow ? 2.0 - x : 1.0) * vec4(radiance(world, lod), 1.0);
    }
    blurred = vec4(sum.rgb / sum.a, 1.0);
}
