// Long arrays lie in textures row by row: element i of one that is ROW wide.
const int ROW_BITS = 14, ROW = 1 << ROW_BITS;

ivec2 row_texel(int i) {
    return ivec2(i & (ROW - 1), i >> ROW_BITS);
}
