#version 330
#include "eye_ray.glsl"
#ifdef PLACED
#include "place.glsl"
#endif
#include "reflected.glsl"
// Shades an object pixel by pixel, however many triangles it has there. With antialiasing,
// coverage samples whose normals are alike are shaded as one; else each by its own normal, for a
// mirror shows what is finer than a pixel.
#ifdef ANTIALIASED
uniform sampler2DMS surfaces;
uniform int coverage_samples;
#define TRIANGLES usampler2DMS
#else
uniform sampler2D surfaces;
#define TRIANGLES usampler2D
const int coverage_samples = 1;
#endif
uniform ivec2 corner; // of the surfaces' rectangle in the framebuffer
uniform float number;
uniform float finest_alpha; // the least width of the object's lobes
layout(location = 0) out vec4 colour;
#ifdef PLACED
uniform TRIANGLES triangles;
uniform float ray_offset; // in front of the triangle, so that it does not hit itself
#endif

vec4 surface_at(ivec2 pixel, int i) {
#ifdef ANTIALIASED
    return texelFetch(surfaces, pixel, i);
#else
    return texelFetch(surfaces, pixel, 0);
#endif
}

// Tells the shading where it happens: on the triangle of a coverage sample.
void place(ivec2 pixel, int i, vec3 ray) {
#ifdef PLACED
    uvec3 corner = corners_of(int(texelFetch(triangles, pixel, i).x)).xyz;
    here_vertices = uint[](corner.x, corner.y, corner.z);
    here_weights = weights_at(corner, ray);
    vec3 a = position_of(corner.x), b = position_of(corner.y), c = position_of(corner.z);
    here_point = mat3(a, b, c) * here_weights;
    here_point += ray_offset * normalize(cross(b - a, c - a));
#endif
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy) - corner;
    vec4 sum = vec4(0.0); // of normals; of the samples that are the object's
    int last = 0;
    for (int i = 0; i < coverage_samples; ++i) {
        vec4 surface = surface_at(pixel, i);
        if (surface.w == number) {
            sum += vec4(surface.xyz, 1.0);
            last = i;
        }
    }
    if (sum.w == 0.0) discard;
    // 2 (1 - r) is the variance of normals whose mean has length r. Below (alpha / 4)² it widens
    // the lobe by 3 % at most.
    float spread = 2.0 * (1.0 - length(sum.xyz) / sum.w);
    bool alike = spread <= finest_alpha * finest_alpha / 16.0;
    vec3 ray = eye_ray(), v = -normalize(ray), L = vec3(0.0);
#ifdef TEXTURED
    place(pixel, last, ray);
    here_ray = ray;
    here_extent = 1.0;
    alike = alike && !(coverage_samples == 4 && changes_within(footprint()));
#endif
    int sets = alike ? 1 : coverage_samples;
    for (int i = 0; i < sets; ++i) {
        vec4 surface = alike ? vec4(normalize(sum.xyz), number) : surface_at(pixel, i);
        if (surface.w != number) continue;
#ifdef TEXTURED
        if (sets == 4) {
            here_ray = ray_through_part(ray, i);
            here_extent = 0.5;
        }
        place(pixel, alike ? last : i, here_ray);
#else
        place(pixel, alike ? last : i, ray);
#endif
        L += reflected(surface.xyz, v, i, sets);
    }
    float share = sum.w / float(coverage_samples);
    colour = vec4(L / (alike ? 1.0 : sum.w) * share, share);
}
