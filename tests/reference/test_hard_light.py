"""What is hard for the path tracer: no light, and no object in sight."""

import numpy as np
import pytest

from reference.batches import render_batch, truth_of
from reports.stability.hard import hard_cases
from reports.stability.hard.inputs import PLASTIC, constant, lit

TRUTHS = ("unoccluded", "direct", "global")


def pictures(case):
    batch = render_batch(case, "model", 4, 1)
    return [truth_of(batch, name).rgb for name in TRUTHS]


@pytest.mark.parametrize("name", ["black", "constant-1e-45"])
def test_without_light_every_truth_is_black(tmp_path, name):
    for picture in pictures(hard_cases()[name].case(tmp_path)):
        assert (picture == 0).all()


@pytest.mark.parametrize("name", ["object-behind", "triangles-edge-on"])
def test_where_no_object_is_seen_every_truth_is_the_environment(tmp_path, name):
    seen = pictures(hard_cases()[name].case(tmp_path))
    for picture in seen:
        assert np.isfinite(picture).all() and picture.min() >= 0.5 and picture.max() <= 1.5
        np.testing.assert_array_equal(picture, seen[0])


def test_the_faintest_light_is_still_light(tmp_path):
    """And scales: the reference has no floor of its own above the one of the loader."""
    ball = ("sphere", PLASTIC, {})
    faint, plain = (pictures(lit(constant(tmp_path, k), ball))[0] for k in (1e-29, 1.0))
    assert (faint > 0).all()
    np.testing.assert_allclose(faint / np.float32(1e-29), plain, rtol=1e-3)
