// Point i of n of a spiral of golden angles (Vogel 1979): on a disc, or a cap, its points lie as evenly
// in every direction. Of several sets each has its own rings between those of the others.
vec2 spiral(int i, int n, int set, int sets) {
    const float GOLDEN = 0.618033988749895; // the fraction whose multiples lie furthest apart
    float ring = (float(i) + (float(set) + 0.5) / float(sets)) / float(n);
    return vec2(ring, fract(GOLDEN * float(i) + (1.0 - GOLDEN) * float(set) + 0.25));
}
