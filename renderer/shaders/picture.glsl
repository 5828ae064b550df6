// Where the framebuffer's lower left pixel lies in the picture that it may be a part of.
uniform ivec2 picture_corner;
uniform vec2 picture_size; // of the whole, in pixels

// The centre of this pixel in the whole picture, in pixels. Not interpolated: a part of a picture
// has the same bits as the whole.
vec2 picture_pixel() {
    return gl_FragCoord.xy + vec2(picture_corner);
}
