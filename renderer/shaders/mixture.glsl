#include "width.glsl"
#include "ndf_ggx.glsl"
#include "ndf_beckmann.glsl"
#include "masking_smith.glsl"
#include "masking_vcavity.glsl"
#ifdef ANISOTROPIC
#include "ndf_anisotropic.glsl"
#include "masking_anisotropic.glsl"
#endif
#ifdef MASKING_SMITH
#include "masking_smith_mixture.glsl"
#endif

// The paper's mixtures, eq. 8 and 9: D = sum w_i D_i, G = sum w_j G_j over GGX and Beckmann.
// x is the share of GGX, y that of Beckmann; a lobe that no weight asks for is not compiled in.
// Under the model's masking `smith`, G is Smith's own for the mixture instead.
float D_mixture(vec3 h, WIDTH alpha, vec2 weight) {
    float D = 0.0;
#ifdef D_GGX
    D += weight.x * D_ggx(h, alpha);
#endif
#ifdef D_BECKMANN
    D += weight.y * D_beckmann(h, alpha);
#endif
    return D;
}

float G_mixture(vec3 wi, vec3 wo, vec3 h, float wo_h, WIDTH alpha, vec2 weight) {
#ifdef MASKING_SMITH
    return G_smith_mixture(wi, wo, alpha, weight);
#else
    float G = 0.0;
#ifdef G_GGX
    G += weight.x * G_smith(wi, wo, alpha);
#endif
#ifdef G_BECKMANN
    G += weight.y * G_vcavity(wi, wo, h, wo_h);
#endif
    return G;
#endif
}
