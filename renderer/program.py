"""Compiled shader programs, each made once, and how uniforms and maps reach them."""

from functools import cache
from typing import Any

import moderngl

from renderer.context import context
from renderer.glsl import source


@cache
def program(
    vertex: str, fragment: str, defines: frozenset[str] = frozenset(), shade: str = ""
) -> moderngl.Program:
    """A program from two shader files; `shade` stands in for the included shade.glsl."""
    parts = {"shade.glsl": shade}
    return context().program(
        vertex_shader=source(vertex), fragment_shader=source(fragment, defines, parts)
    )


def set_uniforms(target: moderngl.Program, **values: Any) -> None:
    """Set those of the uniforms that the program kept; bytes are written as they are."""
    for name, value in values.items():
        if name in target:
            if isinstance(value, bytes):
                target[name].write(value)
            else:
                target[name].value = value


def bind_maps(target: moderngl.Program, maps: dict[str, moderngl.Texture]) -> None:
    """Bind each map that the program reads to a texture unit of its own."""
    for unit, (name, texture) in enumerate(maps.items()):
        if name in target:
            texture.use(unit)
            target[name].value = unit


def fill(
    target: moderngl.Framebuffer,
    fragment: moderngl.Program,
    rectangle: tuple[int, int, int, int] | None = None,
) -> None:
    """Run a fragment program over a framebuffer's pixels, or those of a rectangle in it.

    The rectangle is left, bottom, width, height. The program's `uv` spans the viewport.
    """
    target.scissor = rectangle
    target.use()
    _triangle(fragment).render(moderngl.TRIANGLES, vertices=3)
    target.scissor = None


def _triangle(fragment: moderngl.Program) -> moderngl.VertexArray:
    """A vertex array without vertices: the vertex shader makes them."""
    if fragment.extra is None:  # kept with the program, and gone with it
        fragment.extra = context().vertex_array(fragment, [])
    return fragment.extra
