// Masking and shadowing of V-cavities, Cook and Torrance 1982, eq. 5; it has no width.
float G_vcavity(vec3 wi, vec3 wo, vec3 h, float wo_h) {
    if (wi.z <= 0.0 || wo.z <= 0.0 || wo_h <= 0.0) return 0.0;
    return min(1.0, 2.0 * h.z * min(wi.z, wo.z) / wo_h);
}
