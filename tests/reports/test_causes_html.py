"""The block 'Why' of the report: bars, words and maps say what the ladder holds, and no more."""

import base64
import io
import math
import re
from html.parser import HTMLParser

import numpy as np
import pytest
from PIL import Image

from reports.gate import conclude
from reports.html import causes, write_report
from reports.html.causes import MEASURES, charts
from reports.html.colour import SIGNED
from reports.ladder import MODEL_STEPS, NAMES, RUNGS
from reports.results import CaseRecord, Cause, Figured, Ladder, Results, Row
from reports.run import job
from reports.terminal import why
from scenes.frame import Frame, save_frame

HEIGHT, WIDTH = 48, 96
LOCAL, ENERGY, SSIM = range(len(MEASURES))


def figure(value, half=0.001):
    return Figured(value=value, low=value - half, high=value + half)


def cause(name, energy, local, diffuse=None, ssim=None, parent="", half=0.001):
    return Cause(
        name=name,
        parent=parent,
        energy=figure(energy, half),
        diffuse=None if diffuse is None else figure(diffuse, half),
        local=figure(local, half),
        ssim=None if ssim is None else figure(ssim),
    )


CAUSES = [
    cause("integration", -0.05, 0.1, -0.08, -0.02),
    cause("kd at n·v", -0.06, 0.04, -0.06, parent="integration"),
    cause("irradiance map", 0, 0, 0, parent="integration", half=0),
    cause("prefilter", 0.01, 0.06, 0.0, parent="integration"),
    cause("occlusion", 0.15, 0.35, 0.1, -0.1),
    cause("interreflection", -0.12, -0.05, -0.1, 0.03),
    cause("model", 0.0004, 0.0002, 0.0, 0.0004),
]


def made(**fields):
    """The ladder of an object `left`; fields can be given."""
    base = {
        "case": "spheres.dusk", "object": "left", "technique": "paper", "truth": "physical",
        "causes": CAUSES, "total": cause("total", -0.0196, 0.4002, -0.08, -0.0896),
        "energy_gap": figure(0.0004), "local_gap": figure(-0.0006), "closes": True,
        "missing": {"occlusion": figure(0.96, 0.2), "interreflection": figure(0.84, 0.1)},
    }  # fmt: skip
    return Ladder(**base | fields)


def chart(**fields):
    return charts([made(**fields)])[0]


def words(**fields):
    return " ".join(chart(**fields).sentences).replace("\u202f", " ")


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


class Page(HTMLParser):
    """A page's start tags with their attributes, and all text with what it stands in."""

    def __init__(self, text):
        super().__init__()
        self.elements, self.open, self.said = [], [], []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.elements.append((tag, dict(attributes)))
        self.open.append((tag, dict(attributes)))

    def handle_endtag(self, tag):
        while self.open and self.open.pop()[0] != tag:
            pass

    def handle_data(self, data):
        self.said.append((data, [a.get("class", "") for _, a in self.open]))

    def text(self, kind):
        """What stands in elements of a class."""
        return "".join(t for t, inside in self.said if any(kind in c.split() for c in inside))

    def of(self, kind):
        return [a for _, a in self.elements if kind in a.get("class", "").split()]


@pytest.fixture
def folder(tmp_path):
    """A square drawn by two techniques, and truths that differ by known shares of the last."""
    ids = np.zeros((HEIGHT, WIDTH), np.uint8)
    ids[8:40, 16:80] = 1
    last = np.random.default_rng(1).uniform(0.5, 1, (HEIGHT, WIDTH, 3)).astype(np.float32)
    light = {"physical": 1, "global": 0.96, "direct": 0.88, "unoccluded": 1.08}
    for truth, share in light.items():
        for half in "ab":
            save_frame(Frame(last * np.float32(share), ids), tmp_path / f"{truth}.{half}.exr")
    for technique, share in {"paper": 1.18, "sampled": 1.05}.items():
        save_frame(Frame(last * np.float32(share)), tmp_path / f"{technique}.exr")
    return tmp_path


def written(folder, ladders, techniques=("paper", "sampled")):
    rows = [
        Row(case="spheres.dusk", scene="spheres", environment="dusk", object="left",
            material="copper", roughness=0.4, metallic=1, weight=1, weight_g=1, technique=t,
            truth=truth, exposure=0.5, energy_local=0.1 + (t == "paper"))
        for t in techniques for truth in RUNGS
    ]  # fmt: skip
    case = CaseRecord(
        id="spheres.dusk", scene="spheres", environment="dusk", width=WIDTH, height=HEIGHT,
        objects=["left"], candidates={t: f"{t}.exr" for t in techniques},
        truths={t: (f"{t}.a.exr", f"{t}.b.exr") for t in RUNGS},
    )  # fmt: skip
    run = Results(
        suite="made", suite_path="made.toml", description="One square.", command="none",
        created="2026-01-01T00:00:00Z", seconds=1.0, allow_inconclusive=False,
        expected_rows=len(rows), missing=[], provenance={"device": "none", "parity": []},
        skipped=[], cases=[case], budgets=[], rows=rows, ladders=ladders, verdict="fail",
        reasons=[],
    )  # fmt: skip
    return write_report(conclude(run), folder).read_text(encoding="utf-8")


def both():
    return [made(), made(technique="sampled")]


def test_the_page_shows_the_causes_of_the_chosen_technique(folder):
    page = Page(written(folder, both()))
    blocks = {a["data-technique"]: "hidden" in a for a in page.of("because")}
    assert blocks == {"paper": False, "sampled": True}
    tables = page.of("causes")
    assert [t["aria-label"] for t in tables] == [
        f"Error of left by cause, {t} against physical" for t in blocks
    ]
    said = page.text("causes").replace("\u202f", " ")
    assert "+35.0 ± 0.1 %" in said and "diffuse −8.0, specular +3.0" in said
    assert "leaving a local error of 40.0 %" in page.text("words").replace("\u202f", " ")


def test_bars_are_hidden_from_readers_who_get_the_numbers(folder):
    page = Page(written(folder, both()))
    assert page.of("track") and all(a["aria-hidden"] == "true" for a in page.of("track"))
    assert all("scope" in a for t, a in page.elements if t == "th")


def test_the_parts_that_are_shown_are_explained_and_no_others(folder):
    page = Page(written(folder, both()))
    meanings = page.text("meanings")
    assert "kd at n·v" in meanings and "prefilter" in meanings
    assert "irradiance map" not in meanings and "masking" not in meanings
    assert "blocked by the object itself or by its neighbours" in page.text("occlusion")
    assert "parts indented" in page.text("reading")
    whole = [c for c in CAUSES if not c.parent]
    bare = Page(written(folder, [made(causes=whole)]))
    assert "parts" not in bare.text("meanings") and "parts indented" not in bare.text("reading")


def test_every_part_has_a_meaning():
    for part in ("irradiance map", "kd at n·v", "table", "prefilter", *MODEL_STEPS):
        assert causes.MEANINGS[part]


def test_where_the_causes_end_is_told(folder):
    said = Page(written(folder, both())).text("reading")
    assert "Always up to the last truth of the suite (physical), whatever is selected" in said


def test_an_unknown_interval_has_a_hollow_bar_and_a_grey_number(folder):
    lost = Figured(value=-0.1, low=math.nan, high=math.nan)
    shadow = CAUSES[4].model_copy(update={"ssim": lost})
    page = Page(written(folder, [made(causes=[CAUSES[0], shadow])]))
    assert len(page.of("unknown")) == 1 and "−0.100" in page.text("noise")


def test_steps_that_do_not_sum_are_loud(folder):
    page = Page(written(folder, [made(closes=False, energy_gap=figure(0.1))]))
    assert "do NOT sum" in page.text("problem")
    assert page.text("problem") not in Page(written(folder, both())).text("problem")


def test_a_run_without_ladders_says_nothing_of_causes(folder):
    assert not Page(written(folder, [])).of("why")


def test_hostile_names_stay_text(folder):
    evil = "<script>alert(1)</script>"
    text = written(folder, [made(object=evil, technique=evil)])
    assert evil not in text and evil.replace("<", "&lt;").replace(">", "&gt;") in text


def test_maps_show_each_cause_once_and_integration_for_each_technique(folder):
    page = Page(written(folder, both()))
    maps = {}
    for tag, a in page.elements:
        if tag == "img" and a["alt"].startswith("Error by"):
            data = base64.b64decode(a["src"].removeprefix("data:image/png;base64,"))
            maps[a["alt"]] = np.asarray(Image.open(io.BytesIO(data)).convert("RGBA"))
    percent = {  # of the last truth's light, as the folder's frames are made
        "Error by integration of spheres.dusk, paper": 10,
        "Error by integration of spheres.dusk, sampled": -3,
        "Error by occlusion of spheres.dusk": 20,
        "Error by interreflection of spheres.dusk": -8,
        "Error by model of spheres.dusk": -4,
    }
    assert set(maps) == set(percent)
    for name, share in percent.items():
        assert tuple(maps[name][20, 40]) == (*SIGNED.colours[25 + share], 255), name
        assert maps[name][2, 2, 3] == 0  # off the object


def test_a_shorter_ladder_has_fewer_maps(folder):
    short = made(truth="direct", causes=[CAUSES[0], CAUSES[4]], missing={})
    alts = [a["alt"] for t, a in Page(written(folder, [short])).elements if t == "img"]
    assert sorted(a for a in alts if a.startswith("Error by")) == [
        "Error by integration of spheres.dusk, paper", "Error by occlusion of spheres.dusk",
    ]  # fmt: skip


def test_a_lost_truth_costs_its_own_maps_only(folder):
    (folder / "direct.a.exr").unlink()
    page = Page(written(folder, both()))
    shown = [a["alt"] for t, a in page.elements if t == "img" and a["alt"].startswith("Error by")]
    assert {a.split(" of ")[0] for a in shown} == {"Error by integration", "Error by model"}


def test_causes_take_little_room(folder):
    """Twelve ladders, as of four objects and three techniques, in less than 150 kB."""
    many = [made(object=f"o{i}", technique=t) for i in range(4) for t in "pqr"]
    sizes = [
        len(re.sub(r"data:image/png;base64,[\w+/=]+", "", written(folder, ladders)))
        for ladders in (many, [])
    ]
    assert sizes[0] - sizes[1] < 150e3
