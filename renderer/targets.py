"""Framebuffers: linear float colour, with coverage samples where antialiasing is asked for."""

from dataclasses import dataclass
from functools import cache
from typing import Any

import moderngl
import numpy as np

from renderer.context import context, device
from scenes.errors import InputError

Rectangle = tuple[int, int, int, int]  # left, bottom, width, height, in pixels


@dataclass(frozen=True, eq=False)
class Target:
    """Where a frame is drawn, and where it ends up.

    Attributes:
        drawn: the normal and the number of the object that each pixel shows, or each coverage
            sample; then it spans only `covered`.
        finished: the picture, or the part of it that is asked for.
        covered: the part of `finished` that objects may touch.
        grid: how many pixels of `drawn` a pixel of `finished` has per axis.
    """

    drawn: moderngl.Framebuffer
    finished: moderngl.Framebuffer
    covered: Rectangle
    grid: int = 1

    @property
    def antialiased(self) -> bool:
        """Whether `drawn` has coverage samples."""
        return self.drawn.samples > 0

    @property
    def corner(self) -> tuple[int, int]:
        """Where the lower left pixel of `drawn` lies in `finished`."""
        return self.covered[:2] if self.antialiased else (0, 0)

    def read(self) -> np.ndarray:
        """The finished linear RGB, (H, W, 3) float32, row 0 on top."""
        width, height = self.finished.size
        pixels = np.frombuffer(self.finished.read(components=4, dtype="f4"), np.float32)
        return pixels.reshape(height, width, 4)[::-1, :, :3]

    def release(self) -> None:
        """Free both framebuffers and what hangs on them."""
        attached = {id(a): a for f in (self.drawn, self.finished) for a in _hanging(f)}
        release(self.drawn, self.finished, *attached.values())


def make_target(
    size: tuple[int, int],
    msaa: int,
    covered: Rectangle,
    part: Rectangle,
    placed: bool = False,
    grid: int = 1,
) -> Target:
    """A float32 RGBA target for a part of a picture, with `msaa` samples a pixel, 0 for none.

    float32, since suns exceed the 65,504 that float16 can hold. Whatever the part, the whole
    picture's viewport is drawn, moved: every sample lies where it would in the whole.

    Args:
        size: width and height of the whole picture.
        covered: what objects may touch of it.
        placed: keep the triangle that each sample shows, too.

    Raises:
        InputError: the driver offers no such sizes or not so many samples.
    """
    _offered(size, part, msaa)
    gl, whole = context(), size
    corner, size = part[:2], part[2:]
    covered = within(covered, part)
    colour = gl.renderbuffer(size, 4, dtype="f4")
    if not msaa:
        depth = gl.depth_renderbuffer(size)
        finished = gl.framebuffer([colour], depth)
        finished.depth_mask = False  # its depth is that of `drawn`
        shown = [gl.texture(size, 4, dtype="f4")]
        if placed:
            shown.append(gl.texture(size, 1, dtype="u4"))
        drawn = gl.framebuffer(shown, depth)
        drawn.viewport = (-corner[0], -corner[1], *whole)
        return Target(drawn, finished, covered)
    left, bottom, *inner = covered
    inner = tuple(grid * max(n, 1) for n in inner)
    shown = [gl.texture(inner, 4, samples=msaa, dtype="f4")]
    if placed:
        shown.append(gl.texture(inner, 1, samples=msaa, dtype="u4"))
    drawn = gl.framebuffer(shown, gl.depth_renderbuffer(inner, samples=msaa))
    drawn.viewport = tuple(grid * n for n in (-corner[0] - left, -corner[1] - bottom, *whole))
    return Target(drawn, gl.framebuffer([colour]), covered, grid)


def _offered(whole: tuple[int, int], part: Rectangle, msaa: int) -> None:
    """Refuse what the driver cannot do, before it says so in words of its own."""
    info = context().info
    asked = (
        ("coverage samples", "samples a pixel", msaa, _most_samples()),
        ("picture", "pixels a side", max(whole), min(info["GL_MAX_VIEWPORT_DIMS"])),
        ("part", "pixels a side", max(part[2:]), info["GL_MAX_RENDERBUFFER_SIZE"]),
    )
    for field, unit, count, most in asked:
        if count > most:
            problem = f"{count} {unit} are asked for and {device().name} offers {most}"
            raise InputError("OpenGL", field, problem, f"ask for at most {most}")


def _most_samples() -> int:
    info = context().info
    return min(info["GL_MAX_COLOR_TEXTURE_SAMPLES"], info["GL_MAX_DEPTH_TEXTURE_SAMPLES"])


def _hanging(framebuffer: moderngl.Framebuffer) -> list[Any]:
    """A framebuffer's colour and depth."""
    depth = framebuffer.depth_attachment
    return [*framebuffer.color_attachments, *([depth] if depth else [])]


def clear_depth(framebuffer: moderngl.Framebuffer) -> None:
    """Bind a framebuffer and clear its depth alone: every pixel's colour will be written anyway."""
    viewport, framebuffer.viewport = framebuffer.viewport, (0, 0, *framebuffer.size)
    framebuffer.color_mask = _masks(framebuffer, False)
    framebuffer.use()  # which sets the masks
    framebuffer.clear()
    framebuffer.color_mask = _masks(framebuffer, True)
    framebuffer.viewport = viewport
    framebuffer.use()


def _masks(framebuffer: moderngl.Framebuffer, written: bool) -> Any:
    """What is written of each colour attachment; of a lone one moderngl wants no list."""
    masks = [(written,) * 4] * len(framebuffer.color_attachments)
    return masks if len(masks) > 1 else masks[0]


def within(rectangle: Rectangle, part: Rectangle) -> Rectangle:
    """What of a rectangle lies in a part of the picture, as seen from the part's corner."""
    low = [max(r, p) for r, p in zip(rectangle[:2], part[:2], strict=True)]
    ends = [(rectangle[k] + rectangle[k + 2], part[k] + part[k + 2]) for k in (0, 1)]
    width, height = (max(min(e) - at, 0) for e, at in zip(ends, low, strict=True))
    if not width or not height:
        return 0, 0, 0, 0
    return low[0] - part[0], low[1] - part[1], width, height


def outside(rectangle: Rectangle, size: tuple[int, int]) -> list[Rectangle]:
    """The rest of a picture of `size` (width, height), as up to four rectangles."""
    left, bottom, width, height = rectangle
    right, top = left + width, bottom + height
    rest = [
        (0, 0, size[0], bottom),
        (0, top, size[0], size[1] - top),
        (0, bottom, left, height),
        (right, bottom, size[0] - right, height),
    ]
    return [r for r in rest if r[2] > 0 and r[3] > 0]


def release(framebuffer: moderngl.Framebuffer, *others: Any) -> None:
    """Free a framebuffer and other objects; one that stayed bound would be an error later."""
    _elsewhere().use()
    for used in (framebuffer, *others):
        used.release()


@cache
def _elsewhere() -> moderngl.Framebuffer:
    """A framebuffer to bind in place of one that goes; a headless context has no other."""
    return context().framebuffer([context().renderbuffer((1, 1))])
