#version 330
#include "here.glsl"
#ifdef LIGHTS
#include "lights.glsl"
#endif
// The environment's light on each vertex, through what is open of each coarse direction.
uniform sampler2D normals;
uniform sampler2D flux; // of each vertex and coarse direction, as transport/visibility.py has it
const float FLUX = 255.0 / 8160.0;
const int SUB = 1; // looks a side of a coarse cell
layout(location = 0) out vec4 colour;

// The solid angle of one look. An octahedron's faces are all equally far, so that a cell's falls as
// the cube of the distance: (|x| + |y| + |z|)^-1 of its direction.
float look_angle(vec3 d) {
    float nearness = abs(d.x) + abs(d.y) + abs(d.z);
    // Over the square of the map its cube is pi on average.
    return nearness * nearness * nearness * 4.0 / float(SEEN * SEEN * SUB * SUB);
}

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    uint vertex = uint(texel.y * ROW + texel.x);
    vec3 n = texelFetch(normals, texel, 0).xyz, E = vec3(0.0);
    for (int coarse = 0; coarse < SEEN * SEEN; ++coarse) {
        float through = texelFetch(flux, row_texel(int(vertex) * (SEEN * SEEN) + coarse), 0).x;
        if (through == 0.0) continue;
        vec4 sum = vec4(0.0);
        for (int i = 0; i < SUB * SUB; ++i) {
            vec2 place = vec2(coarse % SEEN, coarse / SEEN) + (vec2(i % SUB, i / SUB) + 0.5) / float(SUB);
            vec3 d = octahedral_point(place / float(SEEN));
            float angle = look_angle(d), weight = max(dot(n, d), 1e-3) * angle;
            sum += weight * vec4(environment(d, incoming_lod(1.0 / angle)), 1.0);
        }
        E += through * sum.rgb / sum.a;
    }
    E *= PI * FLUX;
#ifdef LIGHTS
    for (int i = 0; i < light_count; ++i) {
        vec3 d = light_towards[i].xyz;
        float cos_theta = dot(n, d), share = light_share(i, incoming_lod(1.0 / look_angle(d)));
        if (cos_theta <= 0.0 || share <= 0.0 || !bit(open_bits, vertex, octahedral_cell(d))) continue;
        E += share * cos_theta * light_irradiance[i].rgb;
    }
#endif
    colour = vec4(E, 1.0);
}
