#include "shade.glsl"
#include "drawn_material.glsl"

// What a surface of the drawn material sends to the eye.
// `set` of `sets` tells apart the shading points that share the pixel's directions.
vec3 reflected(vec3 n, vec3 v, int set, int sets) {
    // An interpolated normal that faces away from the eye reflects nothing: Mitsuba's rule too.
    if (dot(n, v) <= 0.0) return vec3(0.0);
    return shade(n, v, drawn_material(), set, sets);
}
