"""The bars of the block 'Why': their length, sides, whiskers and numbers are the ladder's."""

import math

import pytest

from reports.html.causes import MEASURES, charts
from reports.ladder import NAMES
from reports.results import Figured
from tests.reports.ladders import CAUSES, cause, chart, made

LOCAL, ENERGY, SSIM = range(len(MEASURES))


def lines(found):
    return {line.name: line for line in found.lines}


def ends(bar):
    """Where each stretch of a bar starts and ends, by kind, from 0 in percent of the axis."""
    return {s.kind: (s.start - bar.zero, s.start + s.length - bar.zero) for s in bar.spans}


def test_rows_are_causes_each_with_its_parts_and_the_total_last():
    found = chart()
    assert [(line.name, line.part) for line in found.lines] == [
        ("integration", False), ("kd at n·v", True), ("prefilter", True), ("occlusion", False),
        ("interreflection", False), ("model", False), ("total", False),
    ]  # fmt: skip


def test_a_whole_cause_that_is_nought_is_shown():
    none = cause("integration", 0, 0, 0, 0, half=0)
    assert "integration" in lines(chart(causes=[none, *CAUSES[4:]]))


def test_bars_go_from_zero_by_the_size_and_sign_of_their_figure():
    found = lines(chart())
    for measure, field in ((LOCAL, "local"), (SSIM, "ssim")):
        scales = []
        for c in (CAUSES[0], CAUSES[4], CAUSES[5]):
            low, high = ends(found[c.name].bars[measure])["whole"]
            value = getattr(c, field).value
            zero, tip = (low, high) if value > 0 else (high, low)
            assert zero == pytest.approx(0, abs=0.11)
            scales.append(tip / value)
        assert min(scales) > 0 and scales == pytest.approx([scales[0]] * 3, rel=0.02)


def test_diffuse_and_specular_light_stand_end_to_end_or_on_both_sides():
    found = lines(chart())
    occlusion = ends(found["occlusion"].bars[ENERGY])
    assert occlusion["diffuse"][0] == pytest.approx(0, abs=0.11)
    assert occlusion["diffuse"][1] == pytest.approx(occlusion["specular"][0], abs=0.11)
    ratio = occlusion["specular"][1] / occlusion["diffuse"][1]
    assert ratio == pytest.approx(0.15 / 0.1, rel=0.02)
    integration = ends(found["integration"].bars[ENERGY])  # -.08 diffuse, +.03 specular
    assert integration["diffuse"][0] < 0 < integration["specular"][1]
    assert integration["diffuse"][0] / integration["specular"][1] == pytest.approx(-8 / 3, rel=0.02)
    assert found["integration"].bars[ENERGY].split == "diffuse −8.0, specular +3.0"


def test_a_metal_shows_specular_light_alone_and_the_unknown_no_tone():
    metal = [cause(n, 0.1, 0.1, 0.0) for n in NAMES]
    assert list(ends(lines(chart(causes=metal))["occlusion"].bars[ENERGY])) == ["specular"]
    unknown = [cause(n, 0.1, 0.1) for n in NAMES]
    assert list(ends(lines(chart(causes=unknown))["occlusion"].bars[ENERGY])) == ["whole"]


def test_whiskers_span_the_interval():
    wide = [cause("integration", 0.1, 0.1, half=0.05), *CAUSES[4:]]
    bar = lines(chart(causes=wide))["integration"].bars[LOCAL]
    length = bar.spans[0].length
    assert bar.whisker.length == pytest.approx(length, abs=0.2)  # ± half of the figure
    assert bar.whisker.start - bar.zero == pytest.approx(length / 2, abs=0.2)


def test_numbers_stand_beside_the_bars():
    found = lines(chart())
    assert [b.text for b in found["occlusion"].bars] == ["+35.0", "+15.0", "−0.100"]
    assert [b.spread for b in found["occlusion"].bars] == [
        "±\u202f0.1\u202f%", "±\u202f0.1\u202f%", "±\u202f0.001",
    ]  # fmt: skip
    assert found["kd at n·v"].bars[SSIM] is None
    tiny = lines(chart(causes=[cause("integration", -0.0002, 0.0, half=1e-5), *CAUSES[4:]]))
    assert tiny["integration"].bars[ENERGY].text == "0.0"
    assert tiny["integration"].bars[ENERGY].spread == "±\u202f<\u202f0.1\u202f%"


def test_a_sign_that_noise_hides_is_marked():
    found = lines(chart())
    assert all(b.noise for b in found["model"].bars)
    assert not any(b.noise for b in found["occlusion"].bars)


def test_an_interval_that_is_unknown_is_told_and_has_no_whisker():
    lost = Figured(value=-0.1, low=math.nan, high=math.nan)
    shadow = CAUSES[4].model_copy(update={"ssim": lost})
    bar = lines(chart(causes=[CAUSES[0], shadow]))["occlusion"].bars[SSIM]
    assert bar.spread == "±\u202funknown" and bar.whisker is None
    assert bar.noise and bar.unknown
    assert not lines(chart())["model"].bars[SSIM].unknown


def test_both_sides_of_a_skew_interval_are_told():
    def spread(low, high):
        skew = CAUSES[4].model_copy(update={"local": Figured(value=0.35, low=low, high=high)})
        bar = lines(chart(causes=[CAUSES[0], skew]))["occlusion"].bars[LOCAL]
        return bar.spread.replace("\u202f", " ")

    assert spread(-0.12, 0.58) == "−47.0/+23.0 %"
    assert spread(0.25, 0.48) == "± 11.5 %"
    assert spread(0.34999, 0.35004) == "± < 0.1 %"


def test_figures_that_are_no_numbers_leave_a_gap():
    nan = Figured(value=math.nan, low=math.nan, high=math.nan)
    lost = [c.model_copy(update={"local": nan, "ssim": nan}) for c in CAUSES]
    total = made().total.model_copy(update={"local": nan, "ssim": nan})
    found = chart(causes=lost, total=total, local_gap=nan, closes=False)
    assert lines(found)["occlusion"].bars[LOCAL] is None
    assert "lost in the reference's noise" in found.sentences[0]
    assert "nan" not in repr(found).lower()


def test_objects_and_techniques_share_their_scales():
    small = [cause(n, 0.02, 0.03, 0.01) for n in NAMES]
    found = charts([made(), made(causes=small, technique="sampled")])
    assert found[0].heads == found[1].heads
    one, other = (lines(f)["occlusion"].bars[LOCAL].spans[0].length for f in found)
    assert one / other == pytest.approx(0.35 / 0.03, rel=0.05)


@pytest.mark.parametrize("power", [-3, -1, 0, 2])
def test_axes_hold_all_bars_and_end_on_round_numbers(power):
    scale = 10.0**power
    values = zip(NAMES, (1.7, -0.33, 4.1, 0), strict=True)
    causes = [cause(n, v * scale, v * scale, half=0) for n, v in values]
    found = chart(causes=causes, total=cause("total", 5.47 * scale, 5.47 * scale, half=0))
    for line in found.lines:
        for bar in line.bars[:2]:
            for start, end in ends(bar).values():
                assert 0 <= start + bar.zero <= end + bar.zero <= 100.1
    (_, zero), *_ = sorted((abs(p - lines(found)["total"].bars[0].zero), t)
                           for p, t in found.heads[LOCAL][1])  # fmt: skip
    assert zero.startswith("0")
    assert found.heads[LOCAL][1][-1][1].replace("\u202f", "") == f"+{600 * scale:g}%"
