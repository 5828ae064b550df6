#include "rows.glsl"

// A ray against the scene's triangles, by a bounding volume hierarchy laid out depth first, so that
// it needs no stack: where a node's box is missed, `skip` leads on.
uniform sampler2D bvh_nodes;     // least corner, skip; greatest corner, first triangle or -1
uniform sampler2D bvh_triangles; // a corner, number; the edges to the other two

struct Hit {
    float t;       // in lengths of the direction; huge where nothing is hit
    int triangle;  // counted through the scene
    vec3 weights;  // barycentric
    bool front;    // seen from outside
};

const float FAR = 1e30;
const int LEAF = 4; // as in renderer/transport/bvh.py

// Williams et al. 2005, with the slabs of Kay and Kajiya 1986; NaN of 0 times infinity is dropped
// by min and max.
bool meets(vec3 low, vec3 high, vec3 origin, vec3 inverse, float most) {
    vec3 a = (low - origin) * inverse, b = (high - origin) * inverse;
    vec3 near = min(a, b), far = max(a, b);
    return max(max(near.x, near.y), max(near.z, 0.0)) <= min(min(far.x, far.y), min(far.z, most));
}

// Möller and Trumbore 1997.
void meet_triangle(int slot, vec3 origin, vec3 direction, inout Hit hit) {
    vec4 a = texelFetch(bvh_triangles, row_texel(3 * slot), 0);
    vec3 e1 = texelFetch(bvh_triangles, row_texel(3 * slot + 1), 0).xyz;
    vec3 e2 = texelFetch(bvh_triangles, row_texel(3 * slot + 2), 0).xyz;
    vec3 p = cross(direction, e2), s = origin - a.xyz, q = cross(s, e1);
    float inverse = 1.0 / dot(e1, p); // infinite where they are parallel: no u is within [0, 1]
    float u = dot(s, p) * inverse, v = dot(direction, q) * inverse, t = dot(e2, q) * inverse;
    if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0 && t < hit.t) {
        hit = Hit(t, int(a.w), vec3(1.0 - u - v, u, v), inverse > 0.0);
    }
}

// The first hit or, if `any` will do, one of them. Processors that trace many rays together look for
// the next leaf of each before they ask its triangles: Aila and Laine 2009.
Hit trace(vec3 origin, vec3 direction, bool any) {
    Hit hit = Hit(FAR, -1, vec3(0.0), false);
    vec3 inverse = 1.0 / direction;
    int node = 0, end = int(texelFetch(bvh_nodes, ivec2(0), 0).w);
    while (node < end) {
        int first = -1; // triangle of a leaf
        while (node < end && first < 0) {
            vec4 low = texelFetch(bvh_nodes, row_texel(2 * node), 0);
            vec4 high = texelFetch(bvh_nodes, row_texel(2 * node + 1), 0);
            bool met = meets(low.xyz, high.xyz, origin, inverse, hit.t);
            if (met) first = int(high.w);
            node = met ? node + 1 : int(low.w);
        }
        if (first < 0) break;
        for (int k = 0; k < LEAF; ++k) meet_triangle(first + k, origin, direction, hit);
        if (any && hit.triangle >= 0) break;
    }
    return hit;
}

bool blocked(vec3 origin, vec3 direction) {
    return trace(origin, direction, true).triangle >= 0;
}
