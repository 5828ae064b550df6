#version 330
#include "reflected.glsl"
#include "eye_ray.glsl"
// Shades an object pixel by pixel, however many triangles it has there. With antialiasing each
// coverage sample is shaded by its own normal: a mirror shows what is finer than a pixel.
in vec2 uv;
#ifdef ANTIALIASED
uniform sampler2DMS surfaces;
uniform int coverage_samples;
#else
uniform sampler2D surfaces;
const int coverage_samples = 1;
#endif
uniform ivec2 corner; // of the surfaces' rectangle in the picture
uniform float number;
layout(location = 0) out vec4 colour;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy) - corner;
    vec3 v = -normalize(eye_ray(uv));
    vec4 sum = vec4(0.0); // of light; of the samples that are the object's
    for (int i = 0; i < coverage_samples; ++i) {
#ifdef ANTIALIASED
        vec4 surface = texelFetch(surfaces, pixel, i);
#else
        vec4 surface = texelFetch(surfaces, pixel, 0);
#endif
        if (surface.w == number) sum += vec4(reflected(surface.xyz, v, i), 1.0);
    }
    if (sum.w == 0.0) discard;
    colour = sum / float(coverage_samples);
}
