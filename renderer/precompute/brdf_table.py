"""The split sum's second factor: scale and bias for F0.

Under the masking `paper` it is bilinear in the weights of D and G, so a table over n.v and
roughness per pair of lobes serves every material. Under `smith` it is not: G1 is a harmonic mean,
and the product of two of them mixes the weights in all powers. Then each material has a table of
its own, over n.v at its own roughness and weights: a row of 128 texels costs a 128th of a whole
table, and a suite asks for far fewer surfaces than a table has rows.
"""

from collections.abc import Collection
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


def make(_radiance: moderngl.Texture, names: Collection[str]) -> dict[str, moderngl.Texture]:
    """A float32 RGBA texture per lobe of D: scale and bias with G_smith, in zw with G_vcavity.

    x is n.v, y is roughness. The environment is not read: all share them.
    """
    return {name: _made(name, SIZE, SAMPLES) for name in names}


def make_fine(_radiance: moderngl.Texture, names: Collection[str]) -> dict[str, moderngl.Texture]:
    """The same with a quarter of the texels' area and 4 times the samples."""
    return {name: _made(name, FINE_SIZE, FINE_SAMPLES) for name in names}


@cache  # whatever the environment
def _made(name: str, size: tuple[int, int], samples: int) -> moderngl.Texture:
    gl = context()
    texture = gl.texture(size, 4, dtype="f4")
    texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
    texture.repeat_x = texture.repeat_y = False
    lobe = "D_BECKMANN" if "beckmann" in name else "D_GGX"
    shader = program("fullscreen.vert", "brdf_table.frag", frozenset({lobe}))
    set_uniforms(shader, count=samples)
    framebuffer = gl.framebuffer([texture])
    fill(framebuffer, shader)
    release(framebuffer)
    return texture


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
