"""The split sum's second factor: scale and bias for F0 over n.v and roughness, per lobe pair."""

import moderngl

from renderer.context import context
from renderer.program import fill, program, set_uniforms
from renderer.targets import release

SIZE = (128, 128)
SAMPLES = 1024


def make(_radiance: moderngl.Texture) -> dict[str, moderngl.Texture]:
    """Two float32 RGBA textures, D_ggx and D_beckmann; xy with G_smith, zw with G_vcavity.

    x is n.v, y is roughness. The environment is not read.
    """
    gl = context()
    made = {name: gl.texture(SIZE, 4, dtype="f4") for name in ("table_ggx", "table_beckmann")}
    for texture in made.values():
        texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
        texture.repeat_x = texture.repeat_y = False
    shader = program("fullscreen.vert", "brdf_table.frag")
    set_uniforms(shader, count=SAMPLES)
    framebuffer = gl.framebuffer(list(made.values()))
    fill(framebuffer, shader)
    release(framebuffer)
    return made
