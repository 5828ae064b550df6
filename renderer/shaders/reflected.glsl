#include "shade.glsl"
#ifdef VARIES
#include "shading_frame.glsl"
#include "vary.glsl"
#endif
#include "drawn_material.glsl"

// What a surface of the drawn material sends to the eye.
// `set` of `sets` tells apart the shading points that share the pixel's directions.
vec3 reflected(vec3 n, vec3 v, int set, int sets) {
    // An interpolated normal that faces away from the eye reflects nothing: Mitsuba's rule too.
    if (dot(n, v) <= 0.0) return vec3(0.0);
    Material m = drawn_material();
#ifdef VARIES
    vary(m, n);
    if (dot(n, v) <= 0.0) return vec3(0.0);
#endif
    return shade(n, v, m, set, sets);
}
