#version 330
#include "radiance.glsl"
in vec2 uv;
uniform int level; // of the radiance map to sum over
uniform ivec2 fewest; // columns and rows to sum over
layout(location = 0) out vec4 irradiance;

// The polar angle at a height v in texture space: rows are aligned to the poles.
float polar_angle(float v) {
    float rows = float(textureSize(radiance_map, 0).y);
    return PI * (rows > 1.0 ? clamp((v * rows - 0.5) / (rows - 1.0), 0.0, 1.0) : v);
}

// E(n) = integral of L cos: the sum over the texels of a level, or over a grid fine enough for the
// cosine where the map is coarser, each cell with its exact solid angle.
void main() {
    vec3 n = direction_from_latlong(uv, 0.0);
    ivec2 cells = max(textureSize(radiance_map, level), fewest);
    vec3 sum = vec3(0.0);
    for (int y = 0; y < cells.y; ++y) {
        float top = polar_angle(float(y) / float(cells.y));
        float bottom = polar_angle(float(y + 1) / float(cells.y));
        float weight = 2.0 * PI / float(cells.x) * (cos(top) - cos(bottom));
        float v = 0.5 * (top + bottom) * INV_PI;
        for (int x = 0; x < cells.x; ++x) {
            vec2 cell = (vec2(x, y) + 0.5) / vec2(cells); // a texel's centre, where they coincide
            vec3 l = direction_from_latlong(vec2(cell.x, v), 0.0);
            sum += weight * max(dot(n, l), 0.0) * textureLod(radiance_map, cell, float(level)).rgb;
        }
    }
    irradiance = vec4(sum, 1.0);
}
