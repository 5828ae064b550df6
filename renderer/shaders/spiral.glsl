// Point i of n of a spiral of golden angles (Vogel 1979): on a disc, or a cap, its points lie as evenly
// in every direction. Several sets share one spiral of sets times n points; of sets that follow one
// another, which are neighbours in the pixel, the points lie far apart (sets: a power of 2).
vec2 spiral(int i, int n, int set, int sets) {
    const float GOLDEN = 0.618033988749895; // the fraction whose multiples lie furthest apart
    int odd = 2 * (sets / 5) + 1, point = i * sets + set * odd % sets;
    return vec2((float(point) + 0.5) / float(n * sets), fract(GOLDEN * float(point) + 0.25));
}
