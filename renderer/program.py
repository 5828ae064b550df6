"""Compiled shader programs, each made once, and how uniforms and maps reach them."""

import re
from functools import cache
from typing import Any

import moderngl

from renderer.context import context
from renderer.glsl import SHADERS, place_of, source
from scenes.errors import InputError

Maps = dict[str, moderngl.Texture]  # by the names of their samplers in GLSL

# What light comes from a direction, how much of a light is seen, and what shines on an even lobe.
SEAM = ("incoming.glsl", "light_visibility.glsl", "even_light.glsl")
REMEDY = "mend the shader"
_PLACE = re.compile(r"(?:ERROR: )?\d+[:(](\d+)[^:]*:\s*(?:error[^:]*:\s*)?(.+)")


@cache
def program(
    vertex: str,
    fragment: str,
    defines: frozenset[str] = frozenset(),
    shade: str = "",
    incoming: str = "",
) -> moderngl.Program:
    """A program from two shader files.

    `shade` stands in for the included shade.glsl; `incoming`, if given, for the files of SEAM.
    """
    parts = {"shade.glsl": shade}
    if incoming:
        parts |= dict.fromkeys(SEAM, incoming)
    return compiled(source(vertex), source(fragment, defines, parts), str(SHADERS / fragment))


def compiled(vertex: str, fragment: str, where: str) -> moderngl.Program:
    """A program from two whole sources, as `renderer.glsl.source` makes them.

    Args:
        where: what is told of as at fault where the compiler names no file.

    Raises:
        InputError: a shader does not compile, or the two do not fit.
    """
    try:
        return context().program(vertex_shader=vertex, fragment_shader=fragment)
    except moderngl.Error as error:
        raise _refused(str(error), where) from error


def _refused(told: str, where: str) -> InputError:
    """A driver's message in one line, at the file and line of the first error.

    Mesa writes 0:14(20): error: WORDS, NVIDIA 0(14) : error C1008: WORDS, and others
    ERROR: 0:14: WORDS.
    """
    said = [line.strip() for line in told.splitlines() if "error" in line.lower()]
    for line in said:
        if place := _PLACE.match(line):
            where = place_of(int(place[1])) or where
            return InputError(where, "", f"does not compile: {place[2]}", REMEDY)
    problem = said[-1] if said else told
    return InputError(where, "", f"does not compile: {problem}", REMEDY)


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
