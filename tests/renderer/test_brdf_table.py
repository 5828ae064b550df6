"""The split sum's table against double precision."""

import numpy as np
import pytest

from renderer.precompute import brdf_table
from reports.stability.oracle import oracle
from scenes.schema import Material

# 1,024 Hammersley points: masking falls off in a kink at the horizon, and Beckmann is given
# weights up to 4/e. The worst of these points is off by .0038.
TOLERANCE = 0.005
PAIRS = [(d, g) for d in ("ggx", "beckmann") for g in ("smith", "vcavity")]


@pytest.fixture(scope="module")
def tables():
    made = brdf_table.make(None, ("table_ggx", "table_beckmann"))
    width, height = brdf_table.SIZE
    return {
        name: np.frombuffer(texture.read(), np.float32).reshape(height, width, 4)
        for name, texture in made.items()
    }


@pytest.mark.parametrize(("D", "G"), PAIRS, ids=str)
@pytest.mark.parametrize(("column", "row"), [(127, 40), (96, 64), (64, 100), (32, 64), (100, 127)])
def test_table_is_the_integral(tables, over_lobe, D, G, column, row):
    cos_o, roughness = (column + 0.5) / 128, (row + 0.5) / 128
    alpha = roughness**2

    def f(wi, wo):
        both = wi + wo
        wo_h = np.linalg.norm(both, axis=1) / 2
        cos_h = both[:, 2] / (2 * wo_h)
        tan2 = 1 / cos_h**2 - 1
        if D == "ggx":
            density = 1 / (np.pi * alpha**2 * cos_h**4 * (1 + tan2 / alpha**2) ** 2)
        else:
            density = np.exp(-tan2 / alpha**2) / (np.pi * alpha**2 * cos_h**4)
        if G == "smith":
            g1 = [2 / (1 + np.sqrt(1 + alpha**2 * (1 / w[:, 2] ** 2 - 1))) for w in (wi, wo)]
            masking = g1[0] * g1[1]
        else:
            masking = np.minimum(1, 2 * cos_h * np.minimum(wi[:, 2], wo[:, 2]) / wo_h)
        common = density * masking / (4 * wi[:, 2] * wo[:, 2])
        fc = (1 - wo_h) ** 5
        return np.stack([common * (1 - fc), common * fc], axis=1)

    expected = over_lobe(f, alpha, cos_o, 200, 200)
    part = slice(0, 2) if G == "smith" else slice(2, 4)
    np.testing.assert_allclose(tables[f"table_{D}"][row, column, part], expected, atol=TOLERANCE)


def test_a_mirror_reflects_schlick(tables):
    cosine = (np.arange(128) + 0.5) / 128
    fc = (1 - cosine) ** 5
    for table in tables.values():
        # Row 0 is roughness .004; near the horizon even that leaves some samples below it.
        np.testing.assert_allclose(table[0, 8:, 0], (1 - fc)[8:], atol=2e-3)
        np.testing.assert_allclose(table[0, 8:, 1], fc[8:], atol=2e-3)


@pytest.mark.parametrize("alpha", [0.05, 0.25, 0.64])
@pytest.mark.parametrize(
    ("weight", "weight_g"), [(1.0, 1.0), (0.5, 0.5), (0.25, 0.25), (0.0, 0.0), (0.8, 0.1)]
)
def test_a_table_of_smiths_masking_is_the_integral(over_lobe, copper, alpha, weight, weight_g):
    material = copper(alpha, weight, weight_g=weight_g)
    row = np.frombuffer(brdf_table.smith_table(material).texture.read(), np.float32).reshape(-1, 4)
    full, half = (
        Material(roughness=alpha**0.5, metallic=1, metal=f0, weight=weight, weight_g=weight_g)
        for f0 in (1.0, 0.5)
    )
    for column in (127, 64, 32):
        # F is f0 scale + bias: two materials give both.
        one, two = (
            over_lobe(
                lambda wi, wo, m=m: oracle(m, wi, wo, "smith")[:, 0],
                alpha,
                (column + 0.5) / 128,
                200,
                200,
            )
            for m in (full, half)
        )
        scale = 2 * (one - two)
        np.testing.assert_allclose(row[column, :2], [scale, one - scale], atol=TOLERANCE)


def test_a_table_of_smiths_masking_is_made_once_per_surface(copper):
    table = brdf_table.smith_table(copper(0.3, 0.4))
    assert brdf_table.smith_table(copper(0.3, 0.4, name="again")) is table
    assert brdf_table.smith_table(copper(0.3, 0.5)) is not table
    assert table.seconds > 0


def test_ggx_alone_has_the_same_table_under_either_masking(tables, copper):
    # Row 64 of the shared table is roughness 64.5 / 128.
    own = brdf_table.smith_table(copper((64.5 / 128) ** 2)).texture
    row = np.frombuffer(own.read(), np.float32).reshape(-1, 4)
    np.testing.assert_allclose(row[:, :2], tables["table_ggx"][64, :, :2], atol=1e-5)
