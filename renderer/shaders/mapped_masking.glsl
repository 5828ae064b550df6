// What takes the place of G where a pixel covers many normals n' of a map, in brdf.glsl's frame about
// their mean n. The facets' slopes are the map's and their own, added; so of a facet h it is known
// how n' leans: by the map's share of the variance, for normal slopes. About n' the reference has
// F D' G' / (4 n'.wo); D' averaged over the pixel is D h.n / h.n', for as densities of facets over
// directions D' h.n' and D h.n are the same. Where the map has no variance it is G; where it has
// all, h.n n.wo / h.wo: mirrors that stand apart and mask no other.
float mapped_masking(vec3 wi, vec3 wo, vec3 h, float wo_h, Material m) {
    if (h.z <= 1e-6) return 0.0;
    vec2 slopes = h.xy / (h.z * m.alpha);
    vec2 of_ggx = min(2.0 * m.lean / (1.0 + dot(slopes, slopes)), 1.0);
    vec2 lean = m.weight_d.x * of_ggx + m.weight_d.y * m.lean;
    vec3 n = normalize(vec3(lean * h.xy, h.z));
    vec3 x = normalize(vec3(1.0, 0.0, 0.0) - n.x * n);
    mat3 frame = mat3(x, cross(n, x), n);
    vec3 i = wi * frame, o = wo * frame, f = h * frame;
    if (min(i.z, o.z) <= 0.0) return 0.0;
    return G_mixture(i, o, f, wo_h, m.facet_alpha, m.weight_g) * (h.z * wo.z / (f.z * o.z));
}
