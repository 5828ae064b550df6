"""Framebuffers: linear float colour, with coverage samples where antialiasing is asked for."""

from dataclasses import dataclass
from functools import cache
from typing import Any

import moderngl
import numpy as np

from renderer.context import context


@dataclass(frozen=True, eq=False)
class Target:
    """Where a frame is drawn and where it ends up; the same framebuffer without antialiasing."""

    drawn: moderngl.Framebuffer
    resolved: moderngl.Framebuffer

    def read(self) -> np.ndarray:
        """The resolved linear RGB, (H, W, 3) float32, row 0 on top."""
        width, height = self.resolved.size
        pixels = np.frombuffer(self.resolved.read(components=4, dtype="f4"), np.float32)
        return pixels.reshape(height, width, 4)[::-1, :, :3]

    def release(self) -> None:
        """Free both framebuffers and what hangs on them."""
        for framebuffer in {id(f): f for f in (self.drawn, self.resolved)}.values():
            hanging = (*framebuffer.color_attachments, framebuffer.depth_attachment)
            release(framebuffer, *(a for a in hanging if a is not None))


def make_target(size: tuple[int, int], msaa: int) -> Target:
    """A float32 RGBA target of `size` (width, height) with `msaa` samples a pixel, 0 for none.

    float32, since suns exceed the 65,504 that float16 can hold.
    """
    gl = context()
    if not msaa:
        one = gl.framebuffer([gl.renderbuffer(size, 4, dtype="f4")], gl.depth_renderbuffer(size))
        return Target(one, one)
    samples = min(msaa, gl.max_samples)
    drawn = gl.framebuffer(
        [gl.renderbuffer(size, 4, samples=samples, dtype="f4")],
        gl.depth_renderbuffer(size, samples=samples),
    )
    return Target(drawn, gl.framebuffer([gl.renderbuffer(size, 4, dtype="f4")]))


def release(framebuffer: moderngl.Framebuffer, *others: Any) -> None:
    """Free a framebuffer and other objects; one that stayed bound would be an error later."""
    _elsewhere().use()
    for used in (framebuffer, *others):
        used.release()


@cache
def _elsewhere() -> moderngl.Framebuffer:
    """A framebuffer to bind in place of one that goes; a headless context has no other."""
    return context().framebuffer([context().renderbuffer((1, 1))])
