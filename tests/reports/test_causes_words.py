"""The sentences of the block 'Why' say what the ladder holds, and no more."""

import math

import pytest

from reports.html import causes
from reports.ladder import NAMES
from reports.results import Figured
from reports.run import job
from reports.terminal import why
from tests.reports.ladders import CAUSES, cause, chart, figure, made


def words(**fields):
    return " ".join(chart(**fields).sentences).replace("\u202f", " ")


def test_the_causes_of_the_local_error_are_named_by_sign_and_sum():
    balanced = zip(NAMES, (0.212, -0.03, 0.145, -0.129), strict=True)
    told = words(causes=[cause(n, 0, v) for n, v in balanced], total=cause("total", 0, 0.198))
    assert told.startswith(
        "Integration +21.2 and interreflection +14.5 are partly undone by model −12.9 and "
        "occlusion −3.0, leaving a local error of 19.8 %."
    )
    none = [cause("integration", 0, 0.05), cause("occlusion", 0, 0.3502), cause("model", 0, 0)]
    assert words(causes=none).startswith(
        "Occlusion +35.0 and integration +5.0 make a local error of 40.0 %."
    )
    one = [cause("integration", 0, -0.1), cause("occlusion", 0.5, 0.5)]
    assert "Occlusion +50.0 is partly undone by integration −10.0, leaving" in words(causes=one)


def test_numbers_that_do_not_sum_digit_for_digit_say_so():
    assert "leaving a local error of 40.0 %." in words()
    off = words(total=cause("total", -0.0196, 0.4012))
    assert "leaving a local error of 40.1 %, to rounding and noise." in off


def test_what_built_in_techniques_do_not_draw_is_told_plainly():
    plain = "This technique draws no shadows and no light between surfaces."
    assert plain in words() and "lacks" not in words()
    assert "draws no shadows." in words(causes=[CAUSES[0], CAUSES[4]])
    assert "draws" not in words(causes=CAUSES[:4])
    assert "draws no" not in words(technique=causes.OUTSIDE)
    assert causes.OUTSIDE == job.OUTSIDE


def test_what_a_technique_draws_by_its_switches_is_told():
    def told(*switched, **missing):
        return words(switched=[*switched], missing=missing)

    known = {"occlusion": figure(0.04, 0.02), "interreflection": figure(-0.1, 0.03)}
    both = "With its switches on, it draws 96 ± 2 % of the shadows and 110 ± 3 % of the light betw"
    assert both in told("occlusion", "interreflection", **known)
    assert "draws no" not in told("occlusion", "interreflection", **known)
    one = told("occlusion", **known | {"interreflection": figure(1, 0)})
    assert "This technique draws no light between surfaces. With its" in one
    assert "draws 96 ± 2 % of the shadows, by least squares" in one
    skew = Figured(value=0.1, low=-0.3, high=0.2)
    assert "draws 90 −10/+40 % of the shadows" in told("occlusion", occlusion=skew)
    assert "With its" not in told("occlusion", occlusion=figure(0.1, 0.6))
    assert "With its" not in told("model", **known)


def test_what_an_outside_candidate_lacks_is_told_where_it_is_known():
    def told(**missing):
        return words(technique=causes.OUTSIDE, missing=missing)

    known = {"occlusion": figure(0.96, 0.2), "interreflection": figure(0.84, 0.1)}
    both = "lacks 96 ± 20 % of the shadows and 84 ± 10 % of the light between surfaces; its other"
    assert both in told(**known) and "need not mean that some is drawn" in told(**known)
    skew = Figured(value=0.9, low=0.43, high=1.13)
    assert "lacks 90 −47/+23 % of the shadows;" in told(occlusion=skew)
    vague = {"occlusion": figure(1.1, 0.6), "interreflection": figure(math.nan, math.nan)}
    assert "lacks" not in told(**vague)
    assert "lacks 96 ± 20 % of the shadows; its" in told(**vague | {"occlusion": figure(0.96, 0.2)})


def test_errors_that_cancel_in_the_total_are_told():
    told = (
        "In the total, errors cancel: occlusion +15.0 against interreflection −12.0 and "
        "integration −5.0, which leaves −2.0 %."
    )
    assert told in words()
    assert "cancel" not in words(causes=[cause(n, 0.1, 0.1) for n in NAMES])
    hidden = [cause("integration", 0.1, 0.1), cause("occlusion", -0.1, 0.1, half=0.2)]
    assert "cancel" not in words(causes=hidden)


def test_a_cause_whose_sign_is_lost_in_noise_still_counts_among_those_that_cancel():
    vague = cause("model", -0.03, 0, half=0.05)
    total = cause("total", -0.05, 0.4)
    told = words(causes=[*CAUSES[:6], vague], total=total)
    assert "integration −5.0 and model −3.0, which leaves −5.0 %." in told


@pytest.mark.parametrize(
    ("fields", "told", "fine"),
    [
        ({}, "agree within the noise: the gap is −0.06 ± 0.10 % of local", True),
        ({"energy_gap": figure(0.002)}, "differ as one in twenty may", True),
        ({"closes": False, "energy_gap": figure(0.1)}, "do NOT sum to the total", False),
        ({"closes": False, "local_gap": figure(math.nan, math.nan)}, "Too few batches", True),
    ],
)
def test_whether_the_steps_sum_is_told(fields, told, fine):
    found = chart(**fields)
    assert told in found.closure.replace("\u202f", " ")
    assert found.closes == fine


def test_the_terminal_tells_the_causes_in_one_line():
    assert why(made()) == (
        "left in spheres.dusk, paper against physical: integration +10.0%, occlusion +35.0%, "
        "interreflection -5.0%, model +0.0% make 40.0 ± 0.1 % of local energy error "
        "(of other batches)"
    )
    assert "do NOT sum to 40.0 ± 0.1 %" in why(made(closes=False))
    lost = Figured(value=0.4, low=math.nan, high=math.nan)
    total = made().total
    assert "40.0 ± unknown %" in why(made(total=total.model_copy(update={"local": lost})))
    wide = total.model_copy(update={"local": figure(0.4, 0.123)})
    assert "40.0 ± 12 %" in why(made(total=wide))
