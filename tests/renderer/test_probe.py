"""A probe runs the shaders' own functions on exactly the inputs that it is given."""

import numpy as np
import pytest

from renderer.context import context
from renderer.probe import WIDTH, brdf_values, probe
from scenes.schema import Material


def test_every_input_of_a_probe_keeps_its_row():
    rows = np.arange(3000 * 4).reshape(3000, 4)
    expected = rows + rows[:, :1] * [1, 0, 0, 0]
    np.testing.assert_array_equal(probe("a + b", {"a": rows, "b": rows[:, :1]}, ()), expected)


@pytest.mark.parametrize("count", [1, 2, WIDTH, WIDTH + 1])
def test_an_input_of_one_row_holds_for_all(count):
    rows = np.arange(count * 2).reshape(count, 2)
    found = probe("a + b", {"a": rows, "b": [[0.5, 0.25, 2, 3]]}, ())
    expected = np.pad(rows, ((0, 0), (0, 2)))
    np.testing.assert_array_equal(found - expected, np.tile([0.5, 0.25, 2, 3], (count, 1)))


def test_a_probe_reads_the_maps_that_it_is_given():
    texture = context().texture((2, 1), 4, np.float32([[1, 2, 3, 4], [5, 6, 7, 8]]), dtype="f4")
    read = "texelFetch(light, ivec2(x.x, 0), 0)"
    found = probe(
        read, {"x": [0, 1, 1]}, (), declarations="uniform sampler2D light;", maps={"light": texture}
    )
    texture.release()
    np.testing.assert_array_equal(found, [[1, 2, 3, 4], [5, 6, 7, 8], [5, 6, 7, 8]])


def test_values_of_a_material_are_those_of_lambert_where_nothing_is_reflected():
    matte = Material(albedo=(0.5, 0.25, 1), f0=0.0, roughness=1, metallic=0)
    up = np.array([[0.0, 0, 1]])
    # At normal incidence F is F0 = 0, and the whole albedo is left.
    np.testing.assert_allclose(
        brdf_values(matte, up, up), [[0.5 / np.pi, 0.25 / np.pi, 1 / np.pi]], rtol=1e-6
    )
