// What a pixel covers of a picture: a parallelogram of texture coordinates.
struct Footprint {
    vec2 uv; // its middle
    vec2 dx; // its sides
    vec2 dy;
};

// Taps along its longer side, and the level that they read, for a picture of a size in texels.
struct Taps {
    int count;
    vec2 first;
    vec2 stride;
    float lod;
};

const int MOST_TAPS = 16;

// A box of width w varies by w²/12 of a texel. A look-up in level l adds 4^l / 4 to what level 0 blurs
// (its box and its bilinear tent), and one between levels 0 and 1 the fraction of that.
float level_of(float width) {
    float within = width * width / 12.0;
    return within < 1.0 ? within : 0.5 * log2(4.0 * within);
}

Taps taps_of(Footprint f, vec2 size) {
    vec2 a = f.dx * size, b = f.dy * size;
    bool x_longer = dot(a, a) > dot(b, b);
    vec2 longer = x_longer ? f.dx : f.dy;
    float along = clamp(length(longer * size), 1e-6, 65536.0);
    float across = min(abs(a.x * b.y - a.y * b.x) / along, along);
    int count = clamp(int(ceil(along / max(across, 1.7))), 1, MOST_TAPS);
    vec2 stride = longer / float(count);
    float width = max(across, along / float(count));
    return Taps(count, f.uv - 0.5 * (longer - stride), stride, level_of(width));
}
