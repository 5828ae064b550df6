"""What a bench counts as memory."""

import math
import mmap

import moderngl
import pytest

from renderer.context import context
from reports.run.bench import memory


def test_growth_is_the_peak_and_not_what_is_left():
    # Mapped and unmapped by hand: an allocator may keep what it is given back.
    with memory.growing() as growth, mmap.mmap(-1, 1 << 26) as pages:
        for _ in range(64):
            pages.write(bytes(1 << 20))
    assert 60e6 < growth.peak < 90e6
    assert growth.left < 20e6


def test_growth_is_unknown_where_the_system_tells_nothing(tmp_path, monkeypatch):
    monkeypatch.setattr(memory, "STATUS", tmp_path / "none")
    with memory.growing() as growth:
        pass
    assert math.isnan(growth.peak) and math.isnan(growth.left)


def test_held_bytes_are_those_of_live_objects():
    gl, before = context(), memory.held_bytes()
    plain = gl.texture((64, 32), 4, dtype="f4")
    target = gl.renderbuffer((10, 10), 4, samples=4, dtype="f2")
    buffer = gl.buffer(reserve=1000)
    sizes = 64 * 32 * 16 + 10 * 10 * 8 * target.samples + 1000
    assert memory.held_bytes() - before == sizes
    plain.build_mipmaps()
    plain.filter = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)
    assert memory.held_bytes() - before == pytest.approx(sizes + 64 * 32 * 16 / 3)
    for held in (plain, target, buffer):
        held.release()
    assert memory.held_bytes() == before
