"""One frame, pass by pass, in either of two ways.

Per triangle: each triangle's fragments are shaded as they are drawn, then coverage samples are
averaged. Per pixel: triangles leave only their normals, and each pixel is shaded once. A triangle
of a few pixels is shaded in whole 2x2 quads, so a mesh finer than that costs three times as much
per triangle; but only there does each triangle in a pixel count by its own light.
"""

from dataclasses import dataclass
from typing import Any

import moderngl

from renderer.context import context
from renderer.precompute import Maps
from renderer.program import bind_maps, fill, set_uniforms
from renderer.targets import Rectangle, Target, clear_depth, outside, resolve


@dataclass(frozen=True, eq=False)
class Draw:
    """One object ready to be drawn: all that stays the same from frame to frame.

    Attributes:
        vertices, raster: its triangles and the program that they run.
        shading: the program that shades its pixels; None where `raster` does.
        uniforms: of both programs.
        culled: whether its back faces are hidden for sure.
        covered: the part of the picture that it may touch.
    """

    vertices: moderngl.VertexArray
    raster: moderngl.Program
    shading: moderngl.Program | None
    uniforms: dict[str, Any]
    maps: Maps
    culled: bool
    covered: Rectangle


@dataclass(frozen=True, eq=False)
class Prepared:
    """A case ready to be drawn again and again."""

    draws: list[Draw]
    background: moderngl.Program
    background_uniforms: dict[str, Any]
    maps: Maps
    target: Target


def draw_frame(prepared: Prepared) -> None:
    """Draw into `prepared.target.finished`, and wait until it is done."""
    gl, target = context(), prepared.target
    if target.surfaces:
        _per_pixel(prepared)
    else:
        _per_triangle(prepared)
    gl.enable_only(moderngl.NOTHING)
    gl.depth_func = "<"
    gl.finish()


def _per_triangle(prepared: Prepared) -> None:
    gl, target = context(), prepared.target
    clear_depth(target.drawn)
    _rasterise(prepared.draws)
    gl.enable_only(moderngl.DEPTH_TEST)
    gl.depth_func = "<="  # the environment is as far away as can be: depth spares what is hidden
    _background(prepared, target.drawn, None)
    gl.enable_only(moderngl.NOTHING)
    for rectangle in outside(target.covered, target.finished.size):
        _background(prepared, target.finished, rectangle)
    resolve(target)


def _per_pixel(prepared: Prepared) -> None:
    gl, target = context(), prepared.target
    if target.antialiased:
        target.drawn.use()
        target.drawn.clear()
        _rasterise(prepared.draws)
        target.finished.clear(viewport=target.covered)
        gl.enable_only(moderngl.BLEND)
        gl.blend_func = moderngl.ONE, moderngl.ONE  # objects that share a pixel add up
        _shade(prepared)
        gl.blend_func = moderngl.ONE_MINUS_DST_ALPHA, moderngl.ONE
        _background(prepared, target.finished, target.covered)
        gl.enable_only(moderngl.NOTHING)
        for rectangle in outside(target.covered, target.finished.size):
            _background(prepared, target.finished, rectangle)
    else:
        clear_depth(target.drawn)
        _rasterise(prepared.draws)
        gl.enable_only(moderngl.DEPTH_TEST)  # both share it: see make_target
        gl.depth_func = "<="
        _background(prepared, target.finished, None)
        gl.depth_func = ">"
        _shade(prepared)


def _rasterise(draws: list[Draw]) -> None:
    gl = context()
    for draw in draws:
        gl.enable_only(moderngl.DEPTH_TEST | (moderngl.CULL_FACE if draw.culled else 0))
        set_uniforms(draw.raster, **draw.uniforms)
        if not draw.shading:
            bind_maps(draw.raster, draw.maps)
        draw.vertices.render()


def _shade(prepared: Prepared) -> None:
    target = prepared.target
    (surfaces,) = target.drawn.color_attachments
    for draw in prepared.draws:
        set_uniforms(draw.shading, **draw.uniforms, corner=target.corner)
        bind_maps(draw.shading, draw.maps | {"surfaces": surfaces})
        fill(target.finished, draw.shading, draw.covered)


def _background(
    prepared: Prepared, framebuffer: moderngl.Framebuffer, rectangle: Rectangle | None
) -> None:
    set_uniforms(prepared.background, **prepared.background_uniforms)
    bind_maps(prepared.background, prepared.maps)
    fill(framebuffer, prepared.background, rectangle)
