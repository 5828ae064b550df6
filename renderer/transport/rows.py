"""Long arrays in textures, row by row, and shaders that fill them."""

from collections.abc import Sequence
from typing import Any

import moderngl

from renderer.context import context
from renderer.program import Maps, bind_maps, fill, set_uniforms
from renderer.targets import release
from renderer.transport.placed import ROW, row_size


def colours(count: int) -> moderngl.Texture:
    return empty(count, 4, "f4")


def packed(count: int) -> moderngl.Texture:
    """As rgbe.glsl packs colours."""
    return empty(count, 1, "u4")


def empty(count: int, components: int, dtype: str) -> moderngl.Texture:
    texture = context().texture(row_size(count), components, dtype=dtype)
    texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
    return texture


def clear(texture: moderngl.Texture) -> None:
    """Make a packed texture black: of integers GL clears no framebuffer to a colour."""
    texture.write(bytes(4 * texture.width * texture.height))


def run(
    made: Sequence[moderngl.Texture],
    shader: moderngl.Program,
    uniforms: dict[str, Any],
    maps: Maps,
    first: int = 0,
    end: int | None = None,
) -> None:
    """Run a shader over textures of one size, or the rows that hold some of their elements."""
    target = context().framebuffer(made)
    set_uniforms(shader, **uniforms)
    bind_maps(shader, maps)
    last = made[0].height if end is None else -(-end // ROW)
    fill(target, shader, (0, first // ROW, ROW, last - first // ROW))
    release(target)
