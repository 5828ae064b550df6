// Point i of n of the Hammersley set; Holger Dammertz' radical inverse by bit reversal.
vec2 hammersley(uint i, uint n) {
    uint b = (i << 16u) | (i >> 16u);
    b = ((b & 0x55555555u) << 1u) | ((b & 0xAAAAAAAAu) >> 1u);
    b = ((b & 0x33333333u) << 2u) | ((b & 0xCCCCCCCCu) >> 2u);
    b = ((b & 0x0F0F0F0Fu) << 4u) | ((b & 0xF0F0F0F0u) >> 4u);
    b = ((b & 0x00FF00FFu) << 8u) | ((b & 0xFF00FF00u) >> 8u);
    // 24 bits: a 32-bit fraction rounds up to 1.0 in float32.
    return vec2((float(i) + 0.5) / float(n), float(b >> 8u) * (1.0 / 16777216.0));
}
