#version 330
// The box filter over a pixel: the mean of its coverage samples.
uniform sampler2DMS coverage_samples;
uniform int count;
uniform ivec2 corner; // of the samples' rectangle in the picture
layout(location = 0) out vec4 colour;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy) - corner;
    colour = vec4(0.0);
    for (int i = 0; i < count; ++i) colour += texelFetch(coverage_samples, pixel, i);
    colour /= float(count);
}
