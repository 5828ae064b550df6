"""Rays in the shader hit what they hit in Embree."""

import numpy as np
import pytest

from renderer.probe import probe
from renderer.transport.bvh import LEAF, build
from renderer.transport.placed import four
from renderer.transport.rays import Rays
from renderer.transport.rows import holding
from renderer.transport.scene import _tree
from renderer.transport.tessellation import Tessellation


def soup(count):
    rng = np.random.default_rng(7)
    return rng.uniform(-1, 1, (count, 1, 3)) + rng.normal(0, 0.05, (count, 3, 3))


@pytest.mark.parametrize("count", [1, 5, 700])
def test_rays_hit_in_the_shader_what_they_hit_in_embree(count):
    """Embree is asked through the same wrapper that bakes; the tree is that of the shader."""
    triangles = soup(count).astype(np.float32)
    rng = np.random.default_rng(1)
    origins = rng.uniform(-2, 2, (4000, 3)).astype(np.float32)
    directions = triangles[rng.integers(count, size=4000)].mean(axis=1) - origins
    directions[::5, 0] = 0  # along the axes' planes, where 1 / direction is infinite
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    directions = directions.astype(np.float32)
    mesh = Tessellation(
        triangles.reshape(-1, 3).astype(float),
        np.zeros((3 * count, 3), np.float32),
        np.arange(3 * count).reshape(-1, 3),
        np.empty((3 * count, 0), np.float32),
    )
    hits = Rays([mesh], np.zeros(3)).first(origins, directions)
    declared = "vec4 found(Hit h, bool any) { return vec4(h.triangle, h.weights.yz, any); }"
    expression = "found(trace(o.xyz, d.xyz, false), blocked(o.xyz, d.xyz))"
    found = probe(
        expression,
        {"o": origins, "d": directions},
        ("trace.glsl",),
        declarations=declared,
        maps=_tree(triangles),
    )
    same = found[:, 0] == hits.triangle
    assert same.mean() > 0.999  # an edge may go to either side
    assert ((found[:, 3] > 0) == (hits.triangle >= 0)).mean() > 0.999
    hit = same & (hits.triangle >= 0)
    assert hit.any()
    # Triangles seen edge on say little of where they are hit.
    assert np.percentile(np.abs(found[hit, 1] - hits.u[hit]), 99) < 1e-3


def test_every_triangle_stands_in_one_leaf():
    tree = build(soup(700).astype(np.float32))
    held = tree.order[tree.order >= 0]
    assert sorted(held) == list(range(700))
    assert len(tree.nodes) == 2 * len(tree.order) // LEAF - 1
    assert np.isfinite(tree.nodes).all()  # a box at infinity is met by rays that go there


def test_a_pixel_knows_where_in_its_triangle_it_lies():
    corners = np.array([[0, 5, 0], [1, 5, 0], [0, 5, 1]], np.float32)
    positions = holding(four(np.float32(corners)), "f4")
    weights = np.array([[0.2, 0.3, 0.5], [0.6, 0.3, 0.1], [1.2, -0.1, -0.1]])
    found = probe(
        "vec4(weights_at(uvec3(0u, 1u, 2u), ray.xyz), 0.0)",
        {"ray": weights @ corners},
        ("place.glsl",),
        uniforms={"eye": (0.0, 0.0, 0.0)},
        maps={"positions": positions},
    )[:, :3]
    weights[2] = 1, 0, 0  # beside the triangle: moved in
    np.testing.assert_allclose(found, weights, atol=1e-6)
