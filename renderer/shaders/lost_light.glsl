// What the specular lobe does not send back, over n.w, made by precompute/lost_light.py: rgb for the
// diffuse lobe, a for light that meets a second facet. A loss is divided by the root of its mean over
// a hemisphere, so that factor(wi) factor(wo) / pi sends back just what is lost at wo; under
// KD_INTERFACE rg are what the interfaces of GGX and of Beckmann let through, over its mean.
uniform sampler2D lost_light;
float lost_row = 0.5; // of the surface that is shaded, where there are several

// Along the map n.w is y (2 - y), y = x^4: narrow lobes lose light only where n.w is about alpha, and
// near n wide ones do by the third power of the angle, which is no polynomial of n.w.
vec4 lost_light_at(float cos_theta) {
    float texels = float(textureSize(lost_light, 0).x);
    float c = min(cos_theta, 1.0);
    float u = sqrt(sqrt(c / (1.0 + sqrt(1.0 - c))));
    return textureLod(lost_light, vec2((u * (texels - 1.0) + 0.5) / texels, lost_row), 0.0);
}
