// How much of a light is seen: all of it where nothing occludes.
float light_visibility(int light, vec3 world, bool faint) {
    return 1.0;
}

void look_for_lights() {
}
