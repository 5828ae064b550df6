// How much of a light is seen: all of it where nothing occludes.
float light_visibility(int light, vec3 wi_world) {
    return 1.0;
}
