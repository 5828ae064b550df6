"""The split sum's second factor: scale and bias for F0.

Under the masking `paper` it is bilinear in the weights of D and G, so a table over n.v and
roughness per pair of lobes serves every material. Under `smith` it is not: G1 is a harmonic mean,
and the product of two of them mixes the weights in all powers. Then each material has a table of
its own, over n.v at its own roughness and weights: a row of 128 texels costs a 128th of a whole
table, and a suite asks for far fewer surfaces than a table has rows.
"""

from dataclasses import dataclass
from functools import cache
from time import perf_counter

import moderngl

from renderer.context import context
from renderer.program import fill, program, set_uniforms
from renderer.targets import release
from scenes.schema import Material

SIZE = (128, 128)
SAMPLES = 1024
FINE_SIZE, FINE_SAMPLES = (256, 256), 4096


def make(_radiance: moderngl.Texture) -> dict[str, moderngl.Texture]:
    """Two float32 RGBA textures, D_ggx and D_beckmann; xy with G_smith, zw with G_vcavity.

    x is n.v, y is roughness. The environment is not read.
    """
    return _made(SIZE, SAMPLES, "")


def make_fine(_radiance: moderngl.Texture) -> dict[str, moderngl.Texture]:
    """The same with a quarter of the texels' area and 4 times the samples."""
    return _made(FINE_SIZE, FINE_SAMPLES, "_fine")


def _made(size: tuple[int, int], samples: int, ending: str) -> dict[str, moderngl.Texture]:
    gl = context()
    names = [f"table_ggx{ending}", f"table_beckmann{ending}"]
    made = {name: gl.texture(size, 4, dtype="f4") for name in names}
    for texture in made.values():
        texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
        texture.repeat_x = texture.repeat_y = False
    shader = program("fullscreen.vert", "brdf_table.frag")
    set_uniforms(shader, count=samples)
    framebuffer = gl.framebuffer(list(made.values()))
    fill(framebuffer, shader)
    release(framebuffer)
    return made


@dataclass(frozen=True, eq=False)
class SmithTable:
    """Scale and bias over n.v of one surface, in x and y, and the seconds that it took."""

    texture: moderngl.Texture
    seconds: float


def smith_table(material: Material) -> SmithTable:
    """The table of a material under the masking `smith`, made when first asked for."""
    return _smith_table(material.alpha, material.weight, material.masking_weight)


@cache  # a kilobyte each
def _smith_table(alpha: float, weight: float, weight_g: float) -> SmithTable:
    start = perf_counter()
    gl = context()
    texture = gl.texture((SIZE[0], 1), 4, dtype="f4")
    texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
    texture.repeat_x = texture.repeat_y = False
    shader = program("fullscreen.vert", "smith_table.frag", frozenset({"G_GGX", "G_BECKMANN"}))
    set_uniforms(
        shader,
        alpha=alpha,
        weight_d=(weight, 1 - weight),
        weight_g=(weight_g, 1 - weight_g),
        count=SAMPLES,
    )
    framebuffer = gl.framebuffer([texture])
    fill(framebuffer, shader)
    release(framebuffer)
    gl.finish()
    return SmithTable(texture, perf_counter() - start)
