"""Long arrays in textures, row by row, and shaders that fill them."""

from collections.abc import Sequence
from typing import Any

import moderngl
import numpy as np

from renderer.context import context
from renderer.program import Maps, bind_maps, fill, set_uniforms
from renderer.targets import release
from scenes.errors import InputError

ROW = 16_384  # elements of a row, as in shaders/rows.glsl


def size_of(count: int) -> tuple[int, int]:
    """Width and height of a texture of so many elements.

    Raises:
        InputError: the device has no textures as large.
    """
    size = ROW, max(-(-count // ROW), 1)
    most = context().info["GL_MAX_TEXTURE_SIZE"]
    if max(size) > most:
        problem = f"what is baked needs a texture of {size[0]}x{size[1]}; here {most} is the most"
        raise InputError("scene", "objects", problem, "simplify a mesh, or draw without occlusion")
    return size


def holding(values: np.ndarray, dtype: str) -> moderngl.Texture:
    """A texture of values (n, components), one after the other; 0 fills up the last row."""
    texture = empty(len(values), values.shape[1], dtype)
    whole = np.zeros((texture.width * texture.height, values.shape[1]), values.dtype)
    whole[: len(values)] = values
    texture.write(whole.tobytes())
    return texture


def colours(count: int) -> moderngl.Texture:
    return empty(count, 4, "f4")


def packed(count: int) -> moderngl.Texture:
    """As rgbe.glsl packs colours."""
    return empty(count, 1, "u4")


def empty(count: int, components: int, dtype: str) -> moderngl.Texture:
    texture = context().texture(size_of(count), components, dtype=dtype)
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
    channel: int | None = None,
) -> None:
    """Run a shader over textures of one size, or the rows that hold some of their elements; it may
    write one channel alone."""
    target = context().framebuffer(made)
    if channel is not None:
        target.color_mask = tuple(k == channel for k in range(4))
    set_uniforms(shader, **uniforms)
    bind_maps(shader, maps)
    last = made[0].height if end is None else -(-end // ROW)
    fill(target, shader, (0, first // ROW, ROW, last - first // ROW))
    release(target)
