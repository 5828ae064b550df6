"""report.html: whole, offline, honest about what failed, and worst first."""

import base64
import io
import re
from html.parser import HTMLParser

import numpy as np
import pytest
from PIL import Image

from reports.furnace import MASKINGS, energy_claim
from reports.gate import conclude, judge
from reports.html import write_report
from reports.html.colour import NOT_A_NUMBER, SIGNED, SIMILARITY
from reports.html.figures import METRICS, percent
from reports.html.images import MAPS
from reports.html.matrix import cell, matrices
from reports.html.png import colour_map, picture
from reports.html.trust import facts
from reports.results import CaseRecord, Missing, Results, Row
from scenes.frame import Frame, save_frame
from scenes.suite import Budget

HEIGHT, WIDTH = 48, 96
BUDGET = Budget(technique="paper", truth="global", energy_local=0.2, ssim=0.9)
VOID = {"area", "base", "br", "col", "hr", "img", "input", "link", "meta", "source", "wbr"}


class Page(HTMLParser):
    """A page's elements; tells of tags that are not closed in order."""

    def __init__(self, text):
        super().__init__()
        self.open, self.elements, self.text = [], [], {}
        self.feed(text)
        self.close()
        assert not self.open, f"never closed: {self.open}"

    def handle_starttag(self, tag, attributes):
        self.elements.append((tag, dict(attributes)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag, f"</{tag}> closes something else"

    def handle_data(self, data):
        for tag in set(self.open):
            self.text[tag] = self.text.get(tag, "") + data


def row(**fields):
    """A judged row of the object `left`; figures and names can be given."""
    base = {
        "case": "spheres.dusk", "scene": "spheres", "environment": "dusk", "object": "left",
        "material": "copper", "roughness": 0.4, "metallic": 1, "weight": 0.25, "weight_g": 0.25,
        "technique": "paper", "truth": "global", "exposure": 0.3, "ssim": 0.95,
        "ssim_ci95": (0.949, 0.951), "energy_error": 0.01, "energy_ci95": (0.009, 0.011),
        "energy_local": 0.1, "energy_local_ci95": (0.09, 0.11), "frame_ms": 3.2,
    }  # fmt: skip
    return judge(Row(**with_noise(base | fields)), [BUDGET])


def with_noise(fields):
    """Standard errors, of many degrees of freedom, that give a row's 95 % intervals."""
    told = {}
    for stem, power in (("ssim", 1), ("energy", 1), ("energy_local", 2)):
        low, high = fields[f"{stem}_ci95"]
        told[f"{stem}_se"] = (high**power - low**power) / 2 / 1.96
        told[f"{stem}_dof"] = 1e4
    return told | fields


def results(rows, **fields):
    """A run with the given rows and two-object cases to go with them."""
    cases = [
        CaseRecord(
            id=case, scene="spheres", environment="dusk", width=WIDTH, height=HEIGHT,
            objects=["left", "right"], candidates={"paper": "paper.exr"},
            truths={"global": ("a.exr", "b.exr")},
        )
        for case in dict.fromkeys(r.case for r in rows)
    ]  # fmt: skip
    base = {
        "suite": "tiny", "suite_path": "tiny.toml", "description": "Two spheres.",
        "command": "shadeproof compare --suite tiny", "created": "2026-01-01T00:00:00Z",
        "seconds": 1.0, "allow_inconclusive": False, "expected_rows": len(rows), "missing": [],
        "provenance": {"device": "llvmpipe", "parity": [
            {"name": "silhouettes", "passed": True, "detail": "overlap 99 %"},
            {"name": "background", "passed": False, "detail": "off by 3 %"},
        ]},
        "skipped": [], "cases": cases, "budgets": [BUDGET], "rows": rows, "verdict": "fail",
        "reasons": [],
    }  # fmt: skip
    return conclude(Results(**base | fields))


@pytest.fixture
def folder(tmp_path):
    """Frames of two squares: the candidate is 10 % too bright on the left one."""
    ids = np.zeros((HEIGHT, WIDTH), np.uint8)
    ids[8:40, 8:40], ids[8:40, 56:88] = 1, 2
    truth = np.random.default_rng(1).uniform(0.5, 1, (HEIGHT, WIDTH, 3)).astype(np.float32)
    candidate = truth * np.where(ids == 1, np.float32(1.1), 1)[..., None]
    save_frame(Frame(candidate), tmp_path / "paper.exr")
    for name in ("a.exr", "b.exr"):
        save_frame(Frame(truth, ids), tmp_path / name)
    return tmp_path


def written(run, folder):
    return write_report(run, folder).read_text(encoding="utf-8")


def pixels(uri):
    data = base64.b64decode(uri.removeprefix("data:image/png;base64,"))
    return np.asarray(Image.open(io.BytesIO(data)).convert("RGBA"))


def image(page, words):
    """The pixels of the one image whose alternative text starts with `words`."""
    (found,) = [a for t, a in page.elements if t == "img" and a["alt"].startswith(words)]
    return pixels(found["src"])


def test_asks_for_nothing_outside_the_page(folder):
    text = written(results([row()]), folder)
    page = Page(text)
    for tag, attributes in page.elements:
        for name in ("src", "srcset", "data", "poster", "action"):
            assert attributes.get(name, "data:").startswith("data:"), (tag, attributes[name][:80])
        assert attributes.get("href", "#").startswith(("#", "data:")), tag
    # Without the images' own letters, in which anything can occur.
    bare = re.sub(r"data:image/png;base64,[\w+/=]+", "", text)
    assert not re.search(r"https?:|//\w|@import|url\(|fetch\(|XMLHttp|import\(", bare)
    (policy,) = [a["content"] for t, a in page.elements if "http-equiv" in a and t == "meta"]
    assert "default-src 'none'" in policy


def test_holds_together(folder):
    page = Page(written(results([row(), row(object="right", weight=0.5)]), folder))
    ids = [a["id"] for _, a in page.elements if "id" in a]
    assert len(ids) == len(set(ids))
    links = {a["href"][1:] for t, a in page.elements if t == "a"}
    assert links <= set(ids)
    assert {"case--spheres.dusk", "row--spheres.dusk--left--paper--global"} <= set(ids)
    for tag, attributes in page.elements:
        assert tag != "th" or "scope" in attributes
        assert tag != "img" or attributes["alt"]


def test_verdict_names_the_worst(folder):
    rows = [
        row(material="gold", energy_local=0.25, energy_local_ci95=(0.24, 0.26)),
        row(object="right", material="silver", weight=0.75, energy_local=0.312,
            energy_local_ci95=(0.31, 0.314)),
    ]  # fmt: skip
    text = Page(written(results(rows), folder)).text["h1"].replace("\u202f", " ")
    assert text == (
        "FAIL: silver (weight 0.75) on right in spheres/dusk misses its local energy budget: "
        "31.2 % ± 0.2 % against 20 % (paper vs global)."
    )


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({}, "PASS: every budget is kept, the closest is"),
        ({"energy_local_ci95": (0.05, 0.3)}, "FAIL: noise hides whether copper (weight 0.25)"),
        ({"truth": "unoccluded"}, "so nothing was judged; the largest local energy error is 10.0"),
    ],
)
def test_verdict_says_what_kind_of_worst(folder, fields, words):
    assert words in Page(written(results([row(**fields)]), folder)).text["h1"]


def test_a_run_without_budgets_is_reported_and_not_failed(folder):
    run = results([judge(row(), [])], budgets=[])
    page = Page(written(run, folder))
    assert page.text["h1"].startswith("REPORTED: no row has a budget, so nothing was judged")
    assert page.text["title"].startswith("REPORTED")
    assert [a["class"] for t, a in page.elements if t == "h1"] == ["verdict reported"]


def test_verdict_of_a_run_without_rows(folder):
    assert "no case was compared" in Page(written(results([]), folder)).text["h1"]


def test_missing_rows_fail_even_where_all_others_pass(folder):
    lost = Missing(case="spheres.dusk", object="right", technique="paper", truth="global")
    page = Page(written(results([row()], missing=[lost], expected_rows=2), folder))
    assert page.text["h1"].startswith("FAIL: 1 of 2 rows are missing")
    assert "Missing: right, paper vs global" in page.text["section"]


def test_a_row_that_failed_is_seen_with_its_problem(folder):
    broken = row(technique="outside", problem="exit code 139", ssim=np.nan, energy_local=np.nan)
    page = Page(written(results([row(), broken]), folder))
    assert "could not be compared: exit code 139" in page.text["h1"]
    assert "exit code 139" in page.text["table"]
    assert "No picture: exit code 139" in page.text["figure"]
    assert "nan" not in page.text["table"].lower().replace("nan / inf", "")


def test_a_lost_frame_is_told_and_not_fatal(folder):
    (folder / "b.exr").unlink()
    page = Page(written(results([row()]), folder))
    assert "No picture: b.exr: " in page.text["figure"]
    assert image(page, "Candidate of spheres.dusk").shape == (HEIGHT, WIDTH, 4)


def test_hostile_names_stay_text(folder):
    evil = "<script>alert(1)</script>\"' onerror=x"
    run = results([row(material=evil, technique=evil, problem=evil)], command=evil, suite=evil)
    page = Page(written(run, folder))
    assert sum(t == "script" for t, _ in page.elements) == 1
    assert not any("onerror" in a for _, a in page.elements)
    assert evil in page.text["h1"] and evil in page.text["code"]


def test_same_results_make_the_same_bytes(folder):
    run = results([row(), row(object="right")])
    assert written(run, folder) == written(run, folder)


def test_maps_show_the_error_that_is_there(folder):
    page = Page(written(results([row(), row(object="right", weight=0.5)]), folder))
    for kind in ("Signed error of spheres.dusk", "Block energy error of spheres.dusk"):
        shown = image(page, kind)
        assert tuple(shown[20, 20]) == (*SIGNED.colours[35], 255)  # +10 % of ±25 %: 25 + 10
        assert tuple(shown[20, 70]) == (*SIGNED.colours[25], 255)  # no error
        assert shown[0, 0, 3] == 0  # off the objects
    assert tuple(image(page, "SSIM of")[24, 70]) == (*SIMILARITY.colours[100], 255)


def test_colour_maps_clip_and_mark_what_is_no_number():
    values = np.array([[-9.0, 0.0, 9.0, np.nan, 0.1]])
    shown = pixels(colour_map(values, np.array([[True, True, True, True, False]]), SIGNED))[0]
    assert tuple(shown[0, :3]) == tuple(SIGNED.colours[0])
    assert tuple(shown[1, :3]) == (0xF7, 0xF7, 0xF7)
    assert tuple(shown[2, :3]) == tuple(SIGNED.colours[-1])
    assert tuple(shown[3, :3]) == NOT_A_NUMBER
    assert shown[4, 3] == 0


def test_pictures_mark_what_is_no_number():
    rgb = np.full((1, 2, 3), 0.18, np.float32)
    rgb[0, 1, 2] = np.nan
    shown = pixels(picture(rgb, 1.0))[0, :, :3]
    assert tuple(shown[0]) == (118,) * 3  # 0.18 after the sRGB curve
    assert tuple(shown[1]) == NOT_A_NUMBER


@pytest.mark.parametrize(
    ("figures", "state", "undecided"),
    [
        ({"energy_local": 0.1, "energy_local_ci95": (0.09, 0.11)}, "within2", False),
        ({"energy_local": 0.21, "energy_local_ci95": (0.19, 0.23)}, "over1", True),
        ({"energy_local": 0.9, "energy_local_ci95": (0.8, 1.0)}, "over3", False),
        ({"energy_local": np.nan, "energy_local_ci95": (np.nan, np.nan)}, "broken", False),
        ({"truth": "unoccluded"}, "reported", False),
    ],
)
def test_cells_are_coloured_by_margin_and_hatched_by_noise(figures, state, undecided):
    made = cell(METRICS["energy_local"], row(**figures))
    assert (made.state, made.undecided) == (state, undecided)


def test_matrix_shows_the_worst_place_of_a_material(folder):
    far = row(case="spheres.noon", energy_local=0.19, energy_local_ci95=(0.185, 0.195))
    page = Page(written(results([row(), far]), folder))
    (label,) = [a["aria-label"] for t, a in page.elements
                if t == "a" and a.get("aria-label", "").startswith("copper")
                and "Local energy" in a["aria-label"]]  # fmt: skip
    assert "19.0" in label and "the largest error of 2 places" in label


def eased(**figures):
    """A row of another case, whose budget of local energy is .8."""
    loose = BUDGET.model_copy(update={"energy_local": 0.8, "reason": "a lamp"})
    return judge(row(case="spheres.noon", **figures), [loose])


def local_matrix(rows):
    made = next(m for m in matrices(rows) if m.metric == "energy_local")
    ((_, (found,)),) = made.lines
    return found


def test_matrix_shows_the_largest_error_and_what_is_closest_to_its_budget(folder):
    near = row(energy_local=0.19, energy_local_ci95=(0.185, 0.195))
    far = eased(energy_local=0.5, energy_local_ci95=(0.49, 0.51))
    found = local_matrix([near, far])
    told = "19.0\u202f% of 20\u202f%"
    assert (found.text, found.limit) == ("50.0\u202f%", "≤\u202f80\u202f%")
    assert (found.place, found.nearest) == ("spheres.noon", told)
    assert found.href == "#row--spheres.noon--left--paper--global" and told in found.label
    assert told in Page(written(results([near, far]), folder)).text["table"]


def test_matrix_has_the_colour_of_what_is_closest_to_its_budget():
    over = row(energy_local=0.25, energy_local_ci95=(0.24, 0.26))
    far = eased(energy_local=0.5, energy_local_ci95=(0.49, 0.51))
    found = local_matrix([over, far])
    assert found.text == "50.0\u202f%" and found.state == "over1"
    lost = eased(energy_local=np.nan, energy_local_ci95=(np.nan, np.nan))
    assert local_matrix([over, lost]).state == "broken"


def test_matrix_says_one_figure_where_the_largest_is_closest_to_its_budget():
    found = local_matrix([row(), eased(energy_local=0.7, energy_local_ci95=(0.69, 0.71))])
    assert found.place == "spheres.noon" and not found.nearest
    alone = local_matrix([row()])
    assert not alone.place and not alone.nearest
    twins = local_matrix([row(), row(object="right", energy_local=0.15)])
    assert twins.place == "spheres.dusk, right"


def test_trust_shows_parity_that_fails(folder):
    text = Page(written(results([row()]), folder)).text["dl"]
    assert "1 of 2 checks pass; background does not" in text
    assert "FAILS: background, off by 3 %" in text and "llvmpipe" in text


@pytest.mark.parametrize("ours", [True, False])
def test_trust_shows_references_that_other_code_made(folder, ours):
    mine = {"code": "0a7f5396beef", "mitsuba": "3.6.0", "drjit": "1.0.0", "ours": True}
    other = mine | {"code": "1b7f5396beef", "ours": ours}
    run = results([row()])
    run.provenance["references"] = [mine, other]
    (fact,) = [f for f in facts(run) if f.term == "References"]
    assert fact.doubt == (not ours)
    assert ("made by other code: blessed" in fact.text) == (not ours)
    assert ours or fact.detail[0] == "other: code 1b7f5396beef, Mitsuba 3.6.0, Dr.Jit 1.0.0"
    assert fact.text in Page(written(run, folder)).text["dl"]


def test_an_object_off_screen_costs_nothing_else(folder):
    gone = row(object="gone", problem="covers no pixel of the truth", ssim=np.nan)
    run = results([row(), gone])
    run = run.model_copy(update={"cases": [
        c.model_copy(update={"objects": ["left", "right", "gone"]}) for c in run.cases
    ]})  # fmt: skip
    page = Page(written(run, folder))
    assert page.text["figure"].count("No picture: covers no pixel of the truth") == 3  # close-ups
    assert tuple(image(page, "Signed error of spheres.dusk")[20, 20]) == (*SIGNED.colours[35], 255)


@pytest.mark.parametrize("pixels_of_left", [0, 1, 4])
def test_pictures_of_two_by_two(tmp_path, pixels_of_left):
    ids = (np.arange(4) < pixels_of_left).astype(np.uint8).reshape(2, 2)
    rgb = np.full((2, 2, 3), 0.5, np.float32)
    for name in ("paper.exr", "a.exr", "b.exr"):
        save_frame(Frame(rgb, ids), tmp_path / name)
    page = Page(written(results([row(problem="too small", ssim=np.nan)]), tmp_path))
    assert image(page, "Candidate of spheres.dusk").shape == (2, 2, 4)
    assert ("No picture: too small" in page.text["figure"]) == (pixels_of_left == 0)


def test_what_nobody_foresaw_costs_one_picture(folder, monkeypatch):
    def fall(subject):
        raise ZeroDivisionError("no such thing")

    monkeypatch.setitem(MAPS, "blocks", (fall, SIGNED))
    page = Page(written(results([row()]), folder))
    assert page.text["figure"].count("cannot be drawn (ZeroDivisionError: no such thing)") == 1
    assert image(page, "Signed error of spheres.dusk").shape == (HEIGHT, WIDTH, 4)


def test_the_noisiest_row_is_named_with_its_reason(folder):
    loud = row(object="right", case="spheres.noon", truth="direct", energy_local=65.5,
               energy_local_ci95=(63.9, 67.1))  # fmt: skip
    text = Page(written(results([row(), loud]), folder)).text["dl"].replace("\u202f", " ")
    assert (
        "± 160 % (right in spheres.noon, paper vs direct: 6550 % off, its truth has near-black"
    ) in text
    mild = row(object="right", energy_local=0.3, energy_local_ci95=(0.2, 0.4))
    text = Page(written(results([row(), mild]), folder)).text["dl"].replace("\u202f", " ")
    assert "± 10.0 % (right in spheres.dusk, paper vs global)" in text
    assert "near-black" not in text
    assert "right in" not in Page(written(results([mild]), folder)).text["dl"]


def test_noise_of_a_run_without_figures(folder):
    nan = (np.nan,) * 2
    lost = dict.fromkeys(("ssim", "energy_error", "energy_local"), np.nan)
    lost |= dict.fromkeys(("ssim_ci95", "energy_ci95", "energy_local_ci95"), nan)
    for run in (results([row(problem="exit code 1", **lost)]), results([])):
        text = Page(written(run, folder)).text["dl"]
        assert "no row has figures" in text and "no spread" not in text


def test_budgets_say_no_more_than_they_hold(folder):
    zero = Budget(technique="paper", truth="global", weight=0, ssim=0.8, reason="pure Beckmann")
    text = Page(written(results([row()], budgets=[BUDGET, zero]), folder)).text["li"]
    assert "technique paper, truth global, energy_local 0.2, ssim 0.9" in text
    assert "technique paper, truth global, weight 0.0, reason pure Beckmann, ssim 0.8" in text
    assert text.count("reason ") == 1


@pytest.mark.parametrize(
    ("figures", "name"),
    [({"ssim": 0.99}, "local"), ({"energy_error": 0.9, "energy_ci95": (0.8, 1.0)}, "total")],
)
def test_matrix_starts_with_what_the_headline_names(folder, figures, name):
    budget = BUDGET.model_copy(update={"energy_error": 0.5})
    page = Page(written(results([judge(row(**figures), [budget])]), folder))
    assert f"{name} energy" in page.text["h1"]
    (chosen,) = [a["value"] for t, a in page.elements
                 if t == "input" and a["data-axis"] == "energy" and "checked" in a]  # fmt: skip
    shown = {a["data-energy"] for t, a in page.elements
             if t == "table" and "matrix" in a["class"] and "hidden" not in a}  # fmt: skip
    assert chosen == name and shown == {name, ""}


def test_the_energy_claim_tells_what_kd_at_the_view_angle_keeps_and_loses(folder):
    text = " ".join(Page(written(results([row()]), folder)).text["section"].split())
    assert "sends back at most 100.3 % (100.4 % with smith)" in text
    assert "as little as 12.3 % (roughness 1, 89° from the normal" in text
    assert "loses 87.7 % of the light of a white surface" in text
    claim = energy_claim()
    paper, smith = (claim.least("shortcut", masking) for masking in MASKINGS)
    assert paper.figure == pytest.approx(smith.figure)  # 'with either masking'
    assert "no facets are lost or counted twice" in text and "nothing is made" not in text


def test_close_up_of_the_error_says_whose_it_is(folder):
    page = Page(written(results([row()]), folder))
    assert page.text["figcaption"].count("of left only; all else is left grey") == 1


@pytest.mark.parametrize(
    ("expected", "words"),
    [
        (3, "PASS (1 of 3 rows were asked for; 2 cases skipped by the filter): every"),
        (1, "PASS (only a part of the suite was asked for; 2 cases skipped by the filter): every"),
    ],
)
def test_skipped_cases_are_told(folder, expected, words):
    skipped = ["spheres.noon (filter 'dusk')", "spheres.night (filter 'dusk')"]
    page = Page(written(results([row()], expected_rows=expected, skipped=skipped), folder))
    assert page.text["h1"].startswith(words)
    assert "2 cases skipped" in page.text["dl"]
    assert all(f"skipped: {s}" in page.text["details"] for s in skipped)


def test_a_pass_says_what_it_does_not_promise(folder):
    override = BUDGET.model_copy(update={"material": "gold", "reason": "gold is hard"})
    rows = [row(), row(object="right", material="gold")]
    text = written(results(rows, budgets=[BUDGET, override]), folder)
    assert "not a promise of quality; 1 of 2 rows use an override with a reason." in text
    assert "no row uses an override" in written(results([row()]), folder)
    failing = row(energy_local=0.9, energy_local_ci95=(0.8, 1.0))
    assert "promise of quality" not in written(results([failing]), folder)


@pytest.mark.parametrize(
    ("batches", "why"), [(8, "the reference's noise hides it"), (1, "one batch has no spread")]
)
def test_an_interval_that_noise_hides_is_told(folder, batches, why):
    hidden = row(ssim_ci95=(np.nan, np.nan), reference_batches=batches)
    made = cell(METRICS["ssim"], hidden)
    words = f"±\u202funknown: {why}"
    assert words in made.label and made.undecided and made.spread == "±\u202funknown"
    page = Page(written(results([hidden]), folder))
    assert words in page.text["table"]
    assert "noise hides whether" in page.text["h1"] and "SSIM budget" in page.text["h1"]


@pytest.mark.parametrize("value", [np.inf, np.nan])
def test_an_infinite_or_lost_figure_is_text(folder, value):
    lost = row(energy_local=value, energy_local_ci95=(value, value))
    run = results([lost])
    again = Results.model_validate_json(run.model_dump_json())  # where infinity is null
    for page in (Page(written(r, folder)) for r in (run, again)):
        assert "local energy budget" in page.text["h1"]
        assert not re.search(r"\b(nan|inf)\b", page.text["table"].replace("NaN / Inf", ""), re.I)
    assert "has no figure to hold against its local energy budget of 20" in page.text["h1"]
    half = row().model_copy(update={"energy_local_ci95": (0.05, np.inf)})
    assert "unknown" in METRICS["energy_local"].spread(half)
    written(results([half], seconds=np.inf), folder)


@pytest.mark.parametrize(
    ("value", "text"), [(0.31234, "31.2 %"), (-0.0123, "−1.23 %"), (2.5, "250 %"), (np.nan, "–")]
)
def test_percentages_have_three_digits_and_a_unit(value, text):
    assert percent(value).replace("\u202f", " ") == text


def test_a_suite_stays_small(tmp_path):
    """One noisy case of 640x232, 4 objects, 3 techniques, 3 truths: eight such within 25 MB."""
    rng, shape = np.random.default_rng(1), (232, 640)
    ids = np.zeros(shape, np.uint8)
    for i in range(4):
        ids[40:190, 20 + 155 * i : 155 + 155 * i] = 1 + i  # 55 % of the picture
    names, techniques, truths = "abcd", ("p", "q", "r"), ("unoccluded", "global", "physical")

    def save(name):
        """Light that changes from object to object, with 1 % of grain."""
        rgb = (0.5 + 0.1 * ids[..., None]) * rng.normal(1, 0.01, (*shape, 3))
        save_frame(Frame(rgb.astype(np.float32), ids), tmp_path / name)
        return name

    case = CaseRecord(
        id="c", scene="s", environment="e", width=640, height=232, objects=list(names),
        candidates={t: save(f"{t}.exr") for t in techniques},
        truths={t: (save(f"{t}.a.exr"), save(f"{t}.b.exr")) for t in truths},
    )  # fmt: skip
    rows = [
        row(case="c", object=o, technique=t, truth=u)
        for o in names for t in techniques for u in truths
    ]  # fmt: skip
    path = write_report(results(rows, cases=[case]), tmp_path)
    assert 8 * path.stat().st_size < 25e6
