#version 330
uniform int id;
layout(location = 0) out int object_id;

void main() {
    object_id = id;
}
