"""Whose references a run used."""

import numpy as np
import pytest

from reports.run import makers as module
from reports.run.makers import Makers
from scenes.frame import Frame

HERE = {"code": "a" * 64, "mitsuba": "3.6.0", "drjit": "1.0.0"}


@pytest.mark.parametrize(
    ("here", "made", "ours"),
    [
        ({}, {}, True),
        ({}, {"code": "b" * 64}, False),
        ({}, {"mitsuba": "3.5.0"}, False),
        ({"mitsuba": "none", "drjit": "none"}, {}, True),
        ({"mitsuba": "none", "drjit": "none"}, {"code": "b" * 64}, False),
    ],
)
def test_a_maker_is_ours_by_code_and_versions_as_far_as_they_are_known(
    monkeypatch, here, made, ours
):
    monkeypatch.setattr(module, "maker", lambda: HERE | here)
    makers, rgb = Makers(), np.zeros((1, 1, 3), np.float32)
    makers.add([Frame(rgb, provenance=HERE | made | {"seed": seed}) for seed in range(8)])
    (told,) = makers.told()
    assert told["ours"] == ours
    assert told["code"] == (HERE | made)["code"][:12]
    assert told["mitsuba"] == (HERE | made)["mitsuba"]


def test_batches_that_were_made_just_now_are_ours(monkeypatch):
    monkeypatch.setattr(module, "maker", lambda: HERE)
    makers, rgb = Makers(), np.zeros((1, 1, 3), np.float32)
    fresh = {name: HERE[name] for name in ("mitsuba", "drjit")}
    makers.add([Frame(rgb, provenance=fresh), Frame(rgb, provenance=HERE)])
    assert [m["ours"] for m in makers.told()] == [True]
