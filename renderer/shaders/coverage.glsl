#include "eye_ray.glsl"
#include "frame.glsl"

// The coverage samples of a pixel: `part_samples` in each of grid x grid parts.
#ifdef ANTIALIASED
uniform sampler2DMS surfaces; // normal, number of the object
uniform usampler2DMS triangles;
uniform int coverage_samples;
uniform int part_samples;
uniform int grid;
#else
uniform sampler2D surfaces;
uniform usampler2D triangles;
const int coverage_samples = 1;
#endif
uniform float number; // of the drawn object

#ifdef ANTIALIASED
// The pixel of the surfaces' framebuffer in which sample i of a pixel lies.
ivec2 part_of(ivec2 pixel, int i) {
    int part = i / part_samples;
    return grid * pixel + ivec2(part % grid, part / grid);
}

vec4 surface_at(ivec2 pixel, int i) {
    return texelFetch(surfaces, part_of(pixel, i), i % part_samples);
}

int triangle_at(ivec2 pixel, int i) {
    return int(texelFetch(triangles, part_of(pixel, i), i % part_samples).x);
}
#else
vec4 surface_at(ivec2 pixel, int i) {
    return texelFetch(surfaces, pixel, 0);
}

int triangle_at(ivec2 pixel, int i) {
    return int(texelFetch(triangles, pixel, 0).x);
}
#endif

// The solid angle that the mirror directions of a pixel's samples span: as if spread evenly over a
// parallelogram, whose area squared is 144 times the determinant of the covariance.
float mirrored(ivec2 pixel, vec3 v) {
    vec3 mean = vec3(0.0);
    float count = 0.0;
    for (int i = 0; i < coverage_samples; ++i) {
        vec4 surface = surface_at(pixel, i);
        if (surface.w != number) continue;
        mean += reflect(-v, surface.xyz);
        count += 1.0;
    }
    if (dot(mean, mean) == 0.0) return 0.0;
    mat3 to_world = tangent_frame(normalize(mean));
    mean /= count;
    vec3 moments = vec3(0.0); // xx, yy, xy
    for (int i = 0; i < coverage_samples; ++i) {
        vec4 surface = surface_at(pixel, i);
        if (surface.w != number) continue;
        vec2 d = ((reflect(-v, surface.xyz) - mean) * to_world).xy;
        moments += vec3(d * d, d.x * d.y);
    }
    return 12.0 * sqrt(max(moments.x * moments.y - moments.z * moments.z, 0.0)) / count;
}
