#version 330
in vec3 position;
in vec3 normal;
uniform mat4 to_clip;
uniform mat4x3 to_world;
uniform mat3 normals_to_world;
uniform vec3 eye;
// centroid: at a silhouette the pixel's centre may lie outside the triangle.
centroid out vec3 world_normal;
centroid out vec3 to_eye;

void main() {
    // Unit before interpolation, as in the arrays that the reference reads: a stretched object
    // would else lean towards the normals that the stretch makes longest.
    world_normal = normalize(normals_to_world * normal);
    to_eye = eye - to_world * vec4(position, 1.0);
    gl_Position = to_clip * vec4(position, 1.0);
}
