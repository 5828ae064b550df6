#version 330
in vec3 position; // in world space, from the scene's middle
in vec3 normal;   // of new vertices shorter than 1, so that between them it runs as in the mesh
uniform mat4 to_clip;
centroid out vec3 world_normal;

void main() {
    world_normal = normal;
    gl_Position = to_clip * vec4(position, 1.0);
}
