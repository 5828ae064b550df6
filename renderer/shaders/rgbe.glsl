// A colour in 32 bits: three mantissas of 8 and the exponent of the largest (Ward 1991, "Real Pixels").
// It is within .4 % of the largest, and costs a third of the fetches that three floats do.
uint to_rgbe(vec3 colour) {
    float most = max(max(colour.r, colour.g), colour.b);
    if (!(most > 1e-30)) return 0u;
    uint exponent = floatBitsToUint(most * 1.002) >> 23; // 255.5 must not become 256
    uvec3 mantissas = uvec3(max(colour, 0.0) * uintBitsToFloat((261u - exponent) << 23) + 0.5);
    return mantissas.r | mantissas.g << 8 | mantissas.b << 16 | exponent << 24;
}

vec3 from_rgbe(uint rgbe) {
    if (rgbe == 0u) return vec3(0.0);
    vec3 mantissas = vec3(rgbe & 0xFFu, rgbe >> 8 & 0xFFu, rgbe >> 16 & 0xFFu);
    return mantissas * uintBitsToFloat(((rgbe >> 24) - 7u) << 23);
}
