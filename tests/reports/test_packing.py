"""Pixels packed for the page's script, unpacked here as it does (packing.js)."""

import base64
import zlib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from reports.html.packing import packed_places, packed_radiance
from tests.reports.pages import unpacked


def back(text, scale, size):
    """The linear radiance (h, w, 3) that the script reads."""
    return unpacked(zlib.decompress(base64.b64decode(text)), size) * scale


FINITE = st.floats(-(2.0**50), 2.0**50, width=32, allow_subnormal=False)
PICTURES = hnp.arrays(
    np.float32, st.tuples(st.integers(1, 5), st.integers(1, 5), st.just(3)), elements=FINITE
)


@given(PICTURES)
@settings(deadline=None, max_examples=200)
def test_radiance_comes_back_to_half_a_digit_of_half_floats(rgb):
    found = back(*packed_radiance(rgb), rgb.shape[:2])
    largest = np.abs(rgb).max(initial=0)
    dim = largest * 1e-9  # where half floats have fewer digits
    assert (np.abs(found - rgb) <= np.maximum(np.abs(rgb) * 2.0**-11, dim)).all()


def test_what_is_no_number_stays_none():
    rgb = np.array([[[np.nan, np.inf, -np.inf], [65504.0, -65504.0, 1e-3]]], np.float32)
    found = back(*packed_radiance(rgb), (1, 2))
    assert np.isnan(found[0, 0, 0]) and found[0, 0, 1] == np.inf and found[0, 0, 2] == -np.inf
    assert np.isfinite(found[0, 1]).all()


@pytest.mark.parametrize("rgb", [np.zeros((2, 3, 3)), np.full((2, 3, 3), np.nan)])
def test_a_picture_without_light_is_packed(rgb):
    text, scale = packed_radiance(rgb)
    assert scale == 1 and np.array_equal(back(text, scale, (2, 3)), rgb, equal_nan=True)


def test_a_faint_picture_keeps_its_digits():
    rgb = np.random.default_rng(1).uniform(1e-12, 2e-12, (4, 4, 3))
    found = back(*packed_radiance(rgb), (4, 4))
    assert np.abs(found / rgb - 1).max() < 2.0**-11


def test_places_come_back_as_they_are():
    places = np.random.default_rng(1).integers(0, 104, (7, 5)).astype(np.uint8)
    data = zlib.decompress(base64.b64decode(packed_places(places)))
    assert np.array_equal(np.frombuffer(data, np.uint8).reshape(7, 5), places)
