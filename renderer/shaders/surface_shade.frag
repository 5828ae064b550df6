#version 330
#include "eye_ray.glsl"
#include "shading_points.glsl"
#ifdef PLACED
#include "place.glsl"
#endif
#include "reflected.glsl"
#include "mirror_share.glsl"
// Shades an object pixel by pixel, however many triangles it has there. With antialiasing,
// coverage samples whose normals are alike are shaded as one; else each by its own normal, for a
// mirror shows what is finer than a pixel.
uniform ivec2 corner; // of the surfaces' rectangle in the framebuffer
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
    vec3 ray = eye_ray(), v = -normalize(ray), L = vec3(0.0);
    // 2 (1 - r) is the variance of normals whose mean has length r.
    float spread = 2.0 * (1.0 - length(sum.xyz) / sum.w);
#ifdef TEXTURED
    place(pixel, last, ray);
    here_ray = ray;
    here_extent = 1.0;
    bool varied = extent_of(coverage_samples) < 1.0 && changes_within(footprint());
#else
    const bool varied = false;
#endif
    int sets = points_of(spread, varied);
#ifdef GROUPED
    float within = spread / float(sets);
    if (within > alike_variance()) mirror_share = mirrored(pixel, v) / float(sets);
#endif
    int first = (turn.x * sets + turn.y - 1) / turn.y, end = ((turn.x + 1) * sets + turn.y - 1) / turn.y;
    for (int i = first; i < end; ++i) {
        vec4 group = sets == 1 ? vec4(normalize(sum.xyz), 1.0) : group_of(pixel, i, sets, last);
        if (group.w == 0.0) continue;
        vec3 through = sets > 1 ? ray_of(ray, i, sets) : ray;
#ifdef TEXTURED
        here_ray = through;
        here_extent = sets > 1 ? extent_of(sets) : 1.0;
#endif
        place(pixel, last, through);
        L += group.w * reflected(group.xyz, v, i, sets);
    }
    if (sets > 1) L /= sum.w;
    float share = sum.w / float(coverage_samples);
    colour = vec4(L * share, turn.x == 0 ? share : 0.0);
}
