#version 330
#define AT_VERTEX
#include "frame.glsl"
#include "here.glsl"
#include "lights.glsl"
#include "positions.glsl"
#include "trace.glsl"
// A bit for each light that a vertex sees, PASS_LIGHTS of them in each of four channels.
uniform float ray_offset;
uniform int first_light; // of a channel, which is all that is written
const float JUST_BELOW = 0.1, JUST_ABOVE = 0.01; // as in renderer/transport/visibility.py
const float LIFT = 5.0; // offsets: as far as where the rays of that start
const float HALF_CELL = 1.8 / float(SIDE); // of a mean one, along a side
layout(location = 0) out uvec4 seen;

bool open_in(vec3 d) {
    return bit(open_bits, here_vertices[0], octahedral_cell(d));
}

// The direction, or one just above the horizon: pixels between vertices have horizons of their own.
vec3 above(vec3 d, vec3 n) {
    float cos_theta = dot(n, d);
    return cos_theta > -JUST_BELOW ? normalize(d + max(JUST_ABOVE - cos_theta, 0.0) * n) : d;
}

// How many of four directions are open that lie around one, in the cells that it may lie between.
int open_around(vec3 d) {
    mat3 around = tangent_frame(d);
    vec3 x = HALF_CELL * around[0], y = HALF_CELL * around[1];
    return int(open_in(d + x + y)) + int(open_in(d + x - y)) + int(open_in(d - x + y)) + int(open_in(d - x - y));
}

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    here_vertices[0] = uint(texel.y * ROW + texel.x);
    vec3 n = texelFetch(normals, texel, 0).xyz;
    vec3 start = position_of(here_vertices[0]) + LIFT * ray_offset * n;
    uint bits = 0u;
    int hidden[PASS_LIGHTS], count = 0; // as in lights.glsl: found first, asked then
    for (int i = 0; i < PASS_LIGHTS && first_light + i < light_count; ++i) {
        vec3 d = above(light_towards[first_light + i].xyz, n);
        int open = dot(n, d) > 0.0 ? open_around(d) : 0;
        if (open == 4) bits |= 1u << uint(i);
        hidden[count] = i;
        if (open > 0 && open < 4) ++count;
    }
    for (int k = 0; k < count; ++k) {
        int i = hidden[k];
        if (!blocked(start, above(light_towards[first_light + i].xyz, n))) bits |= 1u << uint(i);
    }
    seen = uvec4(bits);
}
