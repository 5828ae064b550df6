"""One frame, pass by pass.

Triangles leave only their normals; then each pixel is shaded once for every object in it. A mesh's
triangles cover a few pixels each, and a fragment shader would run in whole 2x2 quads for each of
them, three times a pixel and more.
"""

from dataclasses import dataclass
from typing import Any

import moderngl

from renderer.context import context
from renderer.program import Maps, bind_maps, fill, set_uniforms
from renderer.targets import Rectangle, Target, clear_depth, outside


@dataclass(frozen=True, eq=False)
class Draw:
    """One object ready to be drawn: all that stays the same from frame to frame.

    Attributes:
        vertices, raster: its triangles and the program that they run.
        shading: the program that shades its pixels.
        uniforms: of both programs.
        culled: whether its back faces are hidden for sure.
        covered: the part of the picture that it may touch.
        turns: in how many passes the shading points of a pixel are shaded.
    """

    vertices: moderngl.VertexArray
    raster: moderngl.Program
    shading: moderngl.Program
    uniforms: dict[str, Any]
    maps: Maps
    culled: bool
    covered: Rectangle
    turns: int


@dataclass(frozen=True, eq=False)
class Prepared:
    """A case ready to be drawn again and again.

    Attributes:
        precomputation: seconds that its materials' tables and the light between its surfaces took.
    """

    draws: list[Draw]
    background: moderngl.Program
    background_uniforms: dict[str, Any]
    maps: Maps
    target: Target
    precomputation: float


def draw_frame(prepared: Prepared) -> None:
    """Draw into `prepared.target.finished`, and wait until it is done."""
    gl = context()
    if prepared.target.antialiased:
        _antialiased(prepared)
    else:
        _plain(prepared)
    gl.enable_only(moderngl.NOTHING)
    gl.depth_func = "<"
    gl.finish()


def _plain(prepared: Prepared) -> None:
    """Every pixel shows one thing, and depth tells which: it spares the shaders of the others."""
    gl, target = context(), prepared.target
    clear_depth(target.drawn)
    _rasterise(prepared.draws)
    gl.enable_only(moderngl.DEPTH_TEST)  # by the depth of `drawn`: see make_target
    gl.depth_func = "<="  # the fullscreen triangle is as far away as can be
    _background(prepared, None)
    gl.depth_func = ">"
    _shade(prepared)


def _antialiased(prepared: Prepared) -> None:
    """Objects and the environment share a pixel by its coverage samples, so their light adds up."""
    gl, target = context(), prepared.target
    target.drawn.use()
    target.drawn.clear()
    _rasterise(prepared.draws)
    target.finished.clear(viewport=target.covered)
    gl.enable_only(moderngl.BLEND)
    gl.blend_func = moderngl.ONE, moderngl.ONE
    _shade(prepared)
    gl.blend_func = moderngl.ONE_MINUS_DST_ALPHA, moderngl.ONE
    _background(prepared, target.covered)
    gl.enable_only(moderngl.NOTHING)
    for rectangle in outside(target.covered, target.finished.size):
        _background(prepared, rectangle)


def _rasterise(draws: list[Draw]) -> None:
    gl = context()
    for draw in draws:
        gl.enable_only(moderngl.DEPTH_TEST | (moderngl.CULL_FACE if draw.culled else 0))
        set_uniforms(draw.raster, **draw.uniforms)
        draw.vertices.render()


def _shade(prepared: Prepared) -> None:
    target = prepared.target
    shown = dict(zip(("surfaces", "triangles"), target.drawn.color_attachments, strict=False))
    for draw in prepared.draws:
        set_uniforms(draw.shading, **draw.uniforms, corner=target.corner, grid=target.grid)
        bind_maps(draw.shading, draw.maps | shown)
        for turn in range(draw.turns):
            set_uniforms(draw.shading, turn=(turn, draw.turns))
            fill(target.finished, draw.shading, draw.covered)


def _background(prepared: Prepared, rectangle: Rectangle | None) -> None:
    set_uniforms(prepared.background, **prepared.background_uniforms)
    bind_maps(prepared.background, prepared.maps)
    fill(prepared.target.finished, prepared.background, rectangle)
