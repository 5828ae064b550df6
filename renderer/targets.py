"""Framebuffers: linear float colour, with coverage samples where antialiasing is asked for."""

from dataclasses import dataclass
from functools import cache
from typing import Any

import moderngl
import numpy as np

from renderer.context import context

Rectangle = tuple[int, int, int, int]  # left, bottom, width, height, in pixels


@dataclass(frozen=True, eq=False)
class Target:
    """Where a frame is drawn, and where it ends up.

    Attributes:
        drawn: the normal and the number of the object that each pixel shows, or each coverage
            sample; then it spans only `covered`.
        finished: the whole picture.
        covered: the part of the picture that objects may touch.
    """

    drawn: moderngl.Framebuffer
    finished: moderngl.Framebuffer
    covered: Rectangle

    @property
    def antialiased(self) -> bool:
        """Whether `drawn` has coverage samples."""
        return self.drawn.samples > 0

    @property
    def corner(self) -> tuple[int, int]:
        """Where the lower left pixel of `drawn` lies in the picture."""
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


def make_target(size: tuple[int, int], msaa: int, covered: Rectangle) -> Target:
    """A float32 RGBA target of `size` (width, height) with `msaa` samples a pixel, 0 for none.

    float32, since suns exceed the 65,504 that float16 can hold.
    """
    gl = context()
    colour = gl.renderbuffer(size, 4, dtype="f4")
    if not msaa:
        depth = gl.depth_renderbuffer(size)
        finished = gl.framebuffer([colour], depth)
        finished.depth_mask = False  # its depth is that of `drawn`
        drawn = gl.framebuffer([gl.texture(size, 4, dtype="f4")], depth)
        return Target(drawn, finished, covered)
    left, bottom, *inner = covered
    inner = max(inner[0], 1), max(inner[1], 1)
    drawn = gl.framebuffer(
        [gl.texture(inner, 4, samples=msaa, dtype="f4")],
        gl.depth_renderbuffer(inner, samples=msaa),
    )
    # The whole picture's viewport, moved: every sample lies where it would without the crop.
    drawn.viewport = (-left, -bottom, *size)
    return Target(drawn, gl.framebuffer([colour]), covered)


def _hanging(framebuffer: moderngl.Framebuffer) -> list[Any]:
    """A framebuffer's colour and depth."""
    depth = framebuffer.depth_attachment
    return [*framebuffer.color_attachments, *([depth] if depth else [])]


def clear_depth(framebuffer: moderngl.Framebuffer) -> None:
    """Bind a framebuffer and clear its depth alone: every pixel's colour will be written anyway."""
    viewport, framebuffer.viewport = framebuffer.viewport, (0, 0, *framebuffer.size)
    framebuffer.color_mask = (False,) * 4
    framebuffer.use()  # which sets the masks
    framebuffer.clear()
    framebuffer.color_mask = (True,) * 4
    framebuffer.viewport = viewport
    framebuffer.use()


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
