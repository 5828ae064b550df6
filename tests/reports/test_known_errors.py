"""Errors of known size: none at size 0, another picture either way, as far off as they say."""

import numpy as np
import pytest

from renderer.draw import Renderer
from renderer.techniques import technique
from reports.limits.known_errors import known_errors, tilted
from scenes.mesh import load_mesh
from scenes.suite import expand, load_suite

SIZES = {"degrees": 5.0, "relative": 0.1, "": 0.03}
NAMES = [error.parameter for error in known_errors(None)]


@pytest.fixture(scope="module")
def case():
    """Three surfaces of both lobes, so that a weight can move either way."""
    suite, path = load_suite("frozen")
    drawn = expand(suite, path)[0].case
    mixed = [
        o.model_copy(update={"material": o.material.model_copy(update={"weight": 0.5})})
        for o in drawn.objects
    ]
    return drawn.model_copy(update={"objects": tuple(mixed)})


@pytest.fixture(scope="module")
def drawn(case, tmp_path_factory):
    """The picture of a case with an error of some signed size."""
    errors = {e.parameter: e for e in known_errors(tmp_path_factory.mktemp("meshes"))}

    def draw(name, size):
        rgb = Renderer(technique("paper"), repeats=0).render(errors[name].case(case, size)).rgb
        return errors[name].picture(rgb, size)

    return draw, errors


@pytest.mark.parametrize("name", NAMES)
def test_an_error_of_no_size_changes_no_picture(name, drawn):
    draw, _ = drawn
    np.testing.assert_allclose(draw(name, 0.0), draw("gain", 0.0), rtol=1e-4, atol=1e-5)


@pytest.mark.parametrize("name", NAMES)
def test_an_error_changes_the_picture_and_otherwise_the_other_way(name, drawn):
    draw, errors = drawn
    size = SIZES[errors[name].unit]
    right, above, below = (draw(name, s) for s in (0.0, size, -size))
    for one, other in ((right, above), (right, below), (above, below)):
        assert np.abs(one - other).max() > 1e-3 * right.max()


def test_roughness_and_weight_stay_between_nought_and_one(case, drawn):
    _, errors = drawn
    for name, field in (("roughness", "roughness"), ("weight", "weight")):
        for size in (-2.0, 2.0):
            changed = errors[name].case(case, size)
            assert {getattr(o.material, field) for o in changed.objects} == {max(size / 2, 0.0)}


def test_f0_moves_by_the_size_for_metals_and_for_plastics(drawn):
    _, errors = drawn
    suite, path = load_suite("default")
    case = expand(suite, path)[0].case
    moved = errors["F0"].case(case, -0.02)
    for before, after in zip(case.objects, moved.objects, strict=True):
        off = np.subtract(after.material.specular_f0, before.material.specular_f0)
        np.testing.assert_allclose(off, -0.02, atol=1e-12)
    assert {o.material.metallic for o in case.objects} == {0.0, 1.0}


@pytest.mark.parametrize("mesh", ["plane", "sphere"])
def test_normals_are_tilted_by_the_angle_and_vertices_stay(mesh, tmp_path):
    right, wrong = load_mesh(mesh), load_mesh(tilted(mesh, 7.0, tmp_path))
    np.testing.assert_allclose(wrong.vertices, right.vertices, atol=1e-6)
    np.testing.assert_array_equal(wrong.faces, right.faces)
    # A normal turns by the whole angle where it is square to the axis.
    square = np.abs(right.normals[:, 0]) < 1e-6
    cosines = (right.normals * wrong.normals).sum(axis=1)[square]
    np.testing.assert_allclose(np.degrees(np.arccos(cosines)), 7.0, atol=0.05)
    assert square.any()
