// Cells of an octahedral map of the sphere, the twin of renderer/transport/directions.py. Fine
// cells are counted through one coarse cell after the other.
const int SIDE = 32, SEEN = 16;
const int PER_SIDE = SIDE / SEEN, PER_SEEN = PER_SIDE * PER_SIDE;

int octahedral_cell(vec3 d) {
    vec2 p = d.xy / (abs(d.x) + abs(d.y) + abs(d.z));
    if (d.z < 0.0) p = (1.0 - abs(p.yx)) * vec2(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0);
    ivec2 cell = clamp(ivec2((0.5 * p + 0.5) * float(SIDE)), 0, SIDE - 1);
    ivec2 coarse = cell / PER_SIDE, fine = cell % PER_SIDE;
    return (coarse.y * SEEN + coarse.x) * PER_SEEN + fine.y * PER_SIDE + fine.x;
}

// The direction of a place in the unit square.
vec3 octahedral_point(vec2 place) {
    vec2 p = 2.0 * place - 1.0;
    float z = 1.0 - abs(p.x) - abs(p.y), fold = max(-z, 0.0);
    return normalize(vec3(p - vec2(p.x < 0.0 ? -fold : fold, p.y < 0.0 ? -fold : fold), z));
}

// The directions through the middles of a fine and of a coarse cell.
vec3 octahedral_direction(int index) {
    int coarse = index / PER_SEEN, fine = index % PER_SEEN;
    ivec2 cell = ivec2(coarse % SEEN, coarse / SEEN) * PER_SIDE + ivec2(fine % PER_SIDE, fine / PER_SIDE);
    return octahedral_point((vec2(cell) + 0.5) / float(SIDE));
}

vec3 coarse_direction(int coarse) {
    return octahedral_point((vec2(coarse % SEEN, coarse / SEEN) + 0.5) / float(SEEN));
}
