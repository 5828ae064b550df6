#version 330
// What a pixel shows of a surface, for surface_shade.frag: its normal, and whose it is.
centroid in vec3 world_normal;
uniform float number; // the object's, from 1
layout(location = 0) out vec4 surface;
#ifdef PLACED
uniform int first_triangle; // of the object, counted through the scene
layout(location = 1) out uint triangle;
#endif

void main() {
    // Between vertices whose normals are opposite they cancel out. What has no normal faces nowhere
    // and reflects nothing.
    float length2 = dot(world_normal, world_normal);
    surface = vec4(length2 > 0.0 ? world_normal * inversesqrt(length2) : vec3(0.0), number);
#ifdef PLACED
    triangle = uint(first_triangle + gl_PrimitiveID);
#endif
}
