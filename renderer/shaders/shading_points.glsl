#include "coverage.glsl"
#include "pass.glsl"

// A pixel's shading points: one for all coverage samples whose normals are alike; else one for each or,
// in a square, for each group of those that are.
#ifdef GROUPED
const int GROUP = 4; // times as many points at each step, as in renderer/techniques.py
uniform int least_points; // powers of it
uniform int most_points;

// By so much normals may vary within a point: a quarter of the variance of facets.
float alike_variance() {
    return finest_alpha * finest_alpha / 8.0;
}

int points_of(float variance, bool varied) {
    if (varied) return most_points;
    // Where normals turn evenly, what is left in each part falls as its area.
    int points = least_points;
    while (points < most_points && variance > float(points) * alike_variance()) points *= GROUP;
    return points;
}

// Along a side of the pixel.
int points_aside(int points) {
    return int(round(sqrt(float(points))));
}
#else
// Below (alpha / 4)² it widens the lobe by 3 % at most.
int points_of(float variance, bool varied) {
    return varied || variance > finest_alpha * finest_alpha / 16.0 ? coverage_samples : 1;
}
#endif

// The mean normal of what a point stands for, and of how many samples; `last` is one of them.
vec4 group_of(ivec2 pixel, int point, int points, inout int last) {
#ifdef GROUPED
    if (points < coverage_samples) {
        int aside = points_aside(points), side = grid / aside, each = side * side * part_samples;
        ivec2 first = side * ivec2(point % aside, point / aside);
        vec4 sum = vec4(0.0);
        for (int k = 0; k < each; ++k) {
            int part = k / part_samples;
            ivec2 at = first + ivec2(part % side, part / side);
            int i = (at.y * grid + at.x) * part_samples + k % part_samples;
            vec4 surface = surface_at(pixel, i);
            if (surface.w != number) continue;
            sum += vec4(surface.xyz, 1.0);
            last = i;
        }
        return vec4(normalize(sum.xyz), sum.w);
    }
#endif
    vec4 surface = surface_at(pixel, point);
    last = point;
    return vec4(surface.xyz, surface.w == number ? 1.0 : 0.0);
}

// The ray through the middle of what a point stands for: a square of parts, a part or, of four
// samples, a quarter of it.
vec3 ray_of(vec3 ray, int point, int points) {
#ifdef ANTIALIASED
    vec2 aside;
#ifdef GROUPED
    if (points < coverage_samples) {
        int along = points_aside(points);
        aside = (vec2(point % along, point / along) + 0.5) / float(along) - 0.5;
    } else
#endif
    {
        int part = point / part_samples;
        aside = (vec2(part % grid, part / grid) + 0.5) / float(grid) - 0.5;
        if (part_samples == 4) aside += (vec2(point & 1, point >> 1 & 1) - 0.5) * (0.5 / float(grid));
    }
    return ray + 2.0 * (aside.x / picture_size.x * right + aside.y / picture_size.y * up);
#else
    return ray;
#endif
}

// How long a side of it is, in pixels.
float extent_of(int points) {
    return inversesqrt(float(points));
}
