"""The block 'Why' on the page: the chosen technique's, with maps, for every reader."""

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
from reports.html.colour import SIGNED
from reports.ladder import MODEL_STEPS, RUNGS
from reports.results import CaseRecord, Figured, Results, Row
from scenes.frame import Frame, load_frame, save_frame
from tests.reports import browser
from tests.reports.ladders import CAUSES, figure, made
from tests.reports.pages import layer, told_layers

HEIGHT, WIDTH = 48, 96


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


def written(folder, ladders, techniques=("paper", "sampled"), named=None):
    """The page; `named` are pictures by truth of techniques that have several."""
    drawn = {t: dict.fromkeys(RUNGS, t) | (named or {}).get(t, {}) for t in techniques}
    rows = [
        Row(case="spheres.dusk", scene="spheres", environment="dusk", object="left",
            material="copper", roughness=0.4, metallic=1, weight=1, weight_g=1, technique=t,
            picture=drawn[t][truth], truth=truth, exposure=0.5, energy_local=0.1 + (t == "paper"))
        for t in techniques for truth in RUNGS
    ]  # fmt: skip
    case = CaseRecord(
        id="spheres.dusk", scene="spheres", environment="dusk", width=WIDTH, height=HEIGHT,
        objects=["left"],
        candidates={p: f"{p}.exr" for own in drawn.values() for p in own.values()},
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


def image_of(page, alt):
    """The pixels of an image by its whole alternative text."""
    (uri,) = (a["src"] for t, a in page.elements if t == "img" and a["alt"] == alt)
    data = base64.b64decode(uri.removeprefix("data:image/png;base64,"))
    return np.asarray(Image.open(io.BytesIO(data)).convert("RGBA"))


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
    alts = {a["alt"] for t, a in page.elements if t == "img"}
    maps = {alt: image_of(page, alt) for alt in alts if alt.startswith("Error by")}
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


@pytest.fixture
def switched(folder):
    """A run of `paper` and of `best`, whose pictures are a known share brighter than each truth."""
    light = {"unoccluded": 1.1, "direct": 0.95, "global": 0.99, "physical": 0.99}
    named = dict(zip(RUNGS, ("best.unoccluded", "best.direct", "best", "best"), strict=True))
    last = load_frame(folder / "physical.a.exr").rgb
    for truth, share in light.items():
        save_frame(Frame(last * np.float32(share)), folder / f"{named[truth]}.exr")
    switches = ["occlusion", "interreflection"]
    ladders = [made(), made(technique="best", switched=switches)]
    return written(folder, ladders, ("paper", "best"), {"best": named})


def chosen(page, kind):
    """The choices of technique and truth under which pictures of a kind are shown, by their alt."""
    shown, found = None, {}
    for tag, a in page.elements:
        if "choice" in a.get("class", "").split():
            shown = a.get("data-technique", ""), a.get("data-truth", "")
        if tag == "img" and a["alt"].startswith(f"{kind} of spheres.dusk"):
            found[a["alt"]] = shown
    return found


def test_the_picture_that_was_measured_is_shown(switched):
    drawn = [t for t in told_layers(switched) if t["kind"] == "candidate"]
    assert {t["name"]: (t["techniques"], t["truths"]) for t in drawn} == {
        "paper": (["paper"], []),
        "best.unoccluded": (["best"], ["unoccluded"]),
        "best.direct": (["best"], ["direct"]),
        "best": (["best"], ["global", "physical"]),
    }
    said = Page(switched).text("pairing")
    assert "best vs unoccluded picture best.unoccluded" in said
    assert "best vs direct picture best.direct" in said and said.count("picture") == 2


def test_maps_of_the_error_are_of_the_picture_that_was_measured(switched):
    for truth, share in {"unoccluded": 2, "direct": 8, "global": 3, "physical": -1}.items():
        shown = layer(switched, "blocks", "best", truth)
        assert SIGNED.palette[shown[20, 40]] == tuple(SIGNED.colours[25 + share]), truth


def test_maps_of_causes_are_of_the_switches_that_a_technique_has(switched):
    """E_k: .02, .07, .03 and -.01 of the last truth's light."""
    page = Page(switched)
    percent = {
        "integration of spheres.dusk, best": 2,
        "occlusion of spheres.dusk, paper": 20,
        "occlusion of spheres.dusk, best": 5,
        "interreflection of spheres.dusk, paper": -8,
        "interreflection of spheres.dusk, best": -4,
        "model of spheres.dusk": -4,
    }
    for name, share in percent.items():
        shown = image_of(page, f"Error by {name}")
        assert tuple(shown[20, 40]) == (*SIGNED.colours[25 + share], 255), name
    assert chosen(page, "Error by model") == {"Error by model of spheres.dusk": ("", "")}


def test_a_page_with_switches_says_so(folder, switched):
    told = "the picture held against each truth has on what that truth has"
    assert told in Page(switched).text("reading")
    assert told not in Page(written(folder, both())).text("reading")


SHOWN = """
const choose = (axis, value) => {
  const input = document.querySelector(`.case input[data-axis=${axis}][value=${value}]`);
  input.checked = true; input.dispatchEvent(new Event("change", {bubbles: true}));
};
for (const technique of ["paper", "best"]) for (const truth of ["direct", "global", "physical"]) {
  choose("technique", technique); choose("truth", truth);
  out[`${technique} ${truth}`] = document.querySelector(".case").viewer.layer("candidate").name;
}
"""


def test_a_browser_shows_the_picture_that_was_measured(folder, switched):
    seen = browser.seen(folder / "report.html", SHOWN)
    named = {"best direct": "best.direct", "best global": "best", "best physical": "best"}
    for pair, name in seen.items():
        assert name == named.get(pair, "paper"), pair
    assert len(seen) == 6
