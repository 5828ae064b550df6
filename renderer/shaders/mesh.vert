#version 330
in vec3 position;
in vec3 normal;
uniform mat4 to_clip;
uniform mat3 normals_to_world;
// centroid: at a silhouette the pixel's centre may lie outside the triangle.
centroid out vec3 world_normal;

void main() {
    // Unit before interpolation, as in the arrays that the reference reads: a stretched object
    // would else lean towards the normals that the stretch makes longest.
    world_normal = normalize(normals_to_world * normal);
    gl_Position = to_clip * vec4(position, 1.0);
}
