#version 330
#include "eye_ray.glsl"
#include "coverage.glsl"
#ifdef PLACED
#include "place.glsl"
#endif
#include "reflected.glsl"
#include "mirror_share.glsl"
// Shades an object pixel by pixel, however many triangles it has there. With antialiasing,
// coverage samples whose normals are alike are shaded as one; else each by its own normal, for a
// mirror shows what is finer than a pixel.
uniform ivec2 corner; // of the surfaces' rectangle in the framebuffer
uniform ivec2 turn;   // the first shading point of this pass, and the last but one
uniform float finest_alpha; // the least width of the object's lobes
layout(location = 0) out vec4 colour;
#ifdef PLACED
uniform float ray_offset; // in front of the triangle, so that it does not hit itself
#endif

// Tells the shading where it happens: on the triangle of a coverage sample.
void place(ivec2 pixel, int i, vec3 ray) {
#ifdef PLACED
    uvec3 corner = corners_of(triangle_at(pixel, i)).xyz;
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
    alike = alike && !(extent_of_sample() < 1.0 && changes_within(footprint()));
#endif
    int sets = alike ? 1 : coverage_samples;
    if (sets > 1) mirror_share = mirrored(pixel, v) / float(sets);
    for (int i = turn.x; i < min(turn.y, sets); ++i) {
        vec4 surface = alike ? vec4(normalize(sum.xyz), number) : surface_at(pixel, i);
        if (surface.w != number) continue;
        vec3 through = sets > 1 ? ray_of(ray, i) : ray;
#ifdef TEXTURED
        here_ray = through;
        here_extent = sets > 1 ? extent_of_sample() : 1.0;
#endif
        place(pixel, alike ? last : i, through);
        L += reflected(surface.xyz, v, i, sets);
    }
    float share = sum.w / float(coverage_samples);
    colour = vec4(L / (alike ? 1.0 : sum.w) * share, turn.x == 0 ? share : 0.0);
}
