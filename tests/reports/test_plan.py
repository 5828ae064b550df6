"""A plan picks what a bench showed to be enough, and writes it as a suite that can be run."""

import json

import numpy as np
import pytest

from reports.results import Figured
from reports.speed.plan import Goal, OutOfReachError, chosen
from reports.speed.points import Bench, Error, Point, Timed, case_digest, save_bench
from scenes.frame import Frame, save_frame
from scenes.suite import expand, load_suite

SCENE = """\
description = "one sphere"
resolution = [64, 48]
[camera]
origin = [0.0, -4.0, 0.0]
target = [0.0, 0.0, 0.0]
fov = 30.0
[[object]]
name = "ball"
mesh = "sphere"
material = "copper"
[[object]]
name = "floor"
mesh = "plane"
material = "white_plastic"
position = [0.0, 0.0, -1.0]
fixed = true
judged = false
"""
SUITE = """\
description = "one ball"
techniques = ["paper-noaa", "sampled@16"]
truths = ["global"]
[model]
masking = "smith"
[reference]
samples_per_batch = 4
max_samples = 32
[[run]]
scene = "ball.toml"
environments = ["studio", "sunset"]
rotation = 30.0
materials = ["own.toml", "gold"]
resolution = [48, 32]
[run.sweep]
weight = [1.0, [0.25, 0.75]]
"""
OWN = 'roughness = 0.5\nmetallic = 1.0\nmetal = "Au"\n'


def point(name, ms, errors, case="ball", family="real-time", digest=""):
    """A point with the errors (value, upper end) of its objects; 1 - SSIM is a tenth of it."""

    def figured(value, high, scale=1.0):
        return Figured(value=value * scale, low=0.0, high=high * scale)

    return Point(
        case=case,
        digest=digest,
        environment="studio",
        width=48,
        height=32,
        family=family,
        name=name,
        frame=Timed(median=ms / 1e3, low=ms / 1e3, high=ms / 1e3, frames=9),
        errors=[
            Error(
                object=f"object{k}",
                material="copper",
                roughness=0.4,
                weight=1.0,
                energy_error=figured(0.0, 0.0),
                energy_local=figured(*error),
                one_minus_ssim=figured(*error, 0.1),
            )
            for k, error in enumerate(errors)
        ],
    )


def bench_of(points, suite_path="suite.toml"):
    return Bench(
        suite="suite",
        suite_path=str(suite_path),
        command="shadeproof bench",
        created="2026-01-01",
        seconds=1.0,
        provenance={},
        points=points,
    )


POINTS = [
    point("fast", 1, [(0.3, 0.35), (0.1, 0.12)]),
    point("middle", 5, [(0.09, 0.12), (0.1, 0.11)]),
    point("slow", 20, [(0.08, 0.09), (0.05, 0.06)]),
    point("slower", 30, [(0.08, 0.09), (0.05, 0.06)]),
    point("Mitsuba 1", 0.1, [(0.01, 0.01)], family="path traced"),
]


@pytest.mark.parametrize(
    ("goal", "name"),
    [
        (Goal("energy_local", max_error=0.4), "fast"),
        (Goal("energy_local", max_error=0.34), "middle"),  # the interval's end decides
        (Goal("energy_local", max_error=0.11), "slow"),  # and every object counts
        (Goal("ssim", max_error=0.0119), "slow"),
        (Goal("energy_local", max_seconds=0.004), "fast"),
        (Goal("energy_local", max_seconds=0.02), "slow"),
        (Goal("energy_local", max_seconds=1.0), "slow"),  # no better for more
    ],
)
def test_the_cheapest_that_is_good_enough_is_picked(goal, name):
    assert {c: p.name for c, p in chosen(bench_of(POINTS), goal).items()} == {"ball": name}


@pytest.mark.parametrize(
    ("goal", "words"),
    [
        (Goal("energy_local", max_error=0.05), ("ball", "slow", "0.09")),
        (Goal("energy_local", max_seconds=1e-4), ("ball", "fast", "1 ms")),
    ],
)
def test_a_goal_out_of_reach_names_the_nearest(goal, words):
    with pytest.raises(OutOfReachError) as caught:
        chosen(bench_of(POINTS), goal)
    assert all(word in str(caught.value) for word in words)


def test_a_case_that_misses_is_told_beside_others_that_do_not():
    other = point("fast", 1, [(0.9, 0.95)], case="far")
    with pytest.raises(OutOfReachError, match="of far meets"):
        chosen(bench_of([*POINTS, other]), Goal("energy_local", max_error=0.4))


def test_an_unknown_error_meets_nothing():
    unknown = [point("paper", 1, [(0.1, float("nan")), (0.1, 0.1)]), point("none", 1, [])]
    for goal in (Goal("energy_local", max_error=9.0), Goal("ssim", max_seconds=9.0)):
        for alone in unknown:
            with pytest.raises(OutOfReachError, match="unknown"):
                chosen(bench_of([alone]), goal)


@pytest.fixture
def measured(tmp_path):
    """A bench of a suite that crosses and sweeps, in a folder of its own, and its path."""
    home = tmp_path / "home"
    home.mkdir()
    for name, text in (("ball.toml", SCENE), ("suite.toml", SUITE), ("own.toml", OWN)):
        (home / name).write_text(text, encoding="utf-8")
    drawn = [e.case for e in expand(*load_suite(str(home / "suite.toml")))]
    cases = {case.id: case_digest(case) for case in drawn}
    # Under `sunset` only the dearer one is good enough.
    points = [
        point("paper-noaa", 2, [(0.1, 0.9 if "sunset" in c else 0.2)], c, digest=d)
        for c, d in cases.items()
    ]
    points += [point("sampled@16", 9, [(0.1, 0.15)], c, digest=d) for c, d in cases.items()]
    save_bench(bench_of(points, home / "suite.toml"), home / "bench.json")
    return home / "bench.json"


def test_a_plan_draws_the_very_cases_that_were_measured(measured, shadeproof, tmp_path):
    to = tmp_path / "plans" / "plan.toml"
    code, out, err = shadeproof("plan", "--max-error", 0.5, "--bench", measured, "--to", to)
    assert (code, err) == (0, "") and "2 ms" in out and "9 ms" in out
    before = expand(*load_suite(str(measured.parent / "suite.toml")))
    suite, path = load_suite(str(to))
    after = expand(suite, path)
    assert [e.case for e in after] == [e.case for e in before]
    for entry in after:
        dear = entry.case.environment.name == "sunset"
        assert entry.techniques == (("sampled@16",) if dear else ("paper-noaa",))
    assert suite.reference.max_samples == 32
    assert {(b.technique, b.truth, b.energy_local) for b in suite.budget} == {
        ("paper-noaa", "global", 0.5),
        ("sampled@16", "global", 0.5),
    }


def test_cases_that_fall_together_elsewhere_take_the_slower_technique(
    measured, shadeproof, tmp_path
):
    to = tmp_path / "plan.toml"
    words = ("--max-error", 0.5, "--bench", measured, "--to", to)
    assert (
        shadeproof("plan", *words, "--environment", "interior", "--environment", "studio")[0] == 0
    )
    entries = {e.case.id: e for e in expand(*load_suite(str(to)))}
    assert len(entries) == 8 + 4
    assert entries["ball.interior.gold.weight=1"].techniques == ("sampled@16",)
    assert entries["ball.interior.gold.weight=1"].case.environment.rotation == 30
    assert entries["ball.studio.gold.weight=1"].techniques == ("paper-noaa",)  # measured there


def test_a_time_is_told_and_judged_by_no_budget(measured, shadeproof):
    code, out, _ = shadeproof("plan", "--max-ms", 3, "--bench", measured)
    assert code == 0 and "[[budget]]" not in out
    assert "# ball.studio.gold.weight=1: paper-noaa, 2 ms" in out


def test_out_of_reach_ends_with_1_and_writes_nothing(measured, shadeproof, tmp_path):
    to = tmp_path / "plan.toml"
    code, out, _ = shadeproof("plan", "--max-error", 0.01, "--bench", measured, "--to", to)
    assert code == 1 and len(out.splitlines()) == 1 and "sampled@16" in out
    assert not to.exists()


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ((), "neither is given"),
        (("--max-error", 0.1, "--max-ms", 3), "both are given"),
        (("--max-error", 0), "greater than 0"),
        (("--max-error", "nan"), "greater than 0"),
        (("--max-error", 1, "--figure", "ssim"), "less than 1"),
        (("--max-error", 0.5, "--to", "plan.txt"), ".toml"),
        (("--max-error", 0.5, "--environment", "mars"), "unknown name 'mars'"),
        (("--max-error", 0.5, "--bench", "nowhere.json"), "run `shadeproof bench` first"),
    ],
)
def test_a_mistake_ends_in_one_line(measured, shadeproof, words, told):
    bench = () if "--bench" in words else ("--bench", measured)
    code, out, err = shadeproof("plan", *words, *bench)
    assert (code, out, len(err.splitlines())) == (2, "", 1)
    assert told in err


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda text: text.replace('"schema_version": 1', '"schema_version": 0'), "version 0"),
        (lambda text: text[:-40], "is not JSON"),
        (lambda _: "", "is not JSON"),
        (lambda _: '{"suite": "x"}', "suite_path is missing"),
    ],
)
def test_a_bench_json_that_cannot_be_read_is_told_in_plain_words(
    measured, shadeproof, change, told
):
    measured.write_text(change(measured.read_text()))
    code, out, err = shadeproof("plan", "--max-error", 0.5, "--bench", measured)
    assert (code, out, len(err.splitlines())) == (2, "", 1)
    assert told in err and "validation" not in err and "run `shadeproof bench` again" in err


def test_a_suite_that_changed_since_is_told(measured, shadeproof):
    suite = measured.parent / "suite.toml"
    suite.write_text(SUITE.replace('"gold"', '"silver"'))
    code, _, err = shadeproof("plan", "--max-error", 0.5, "--bench", measured)
    assert code == 2 and "has no case 'ball.studio.gold.weight=0.25' any more" in err
    suite.unlink()
    code, _, err = shadeproof("plan", "--max-error", 0.5, "--bench", measured)
    assert code == 2 and "a suite that is gone" in err


@pytest.mark.parametrize(
    ("name", "before", "after"),
    [
        ("suite.toml", "[48, 32]", "[96, 64]"),
        ("suite.toml", "rotation = 30.0", "rotation = 31.0"),
        ("ball.toml", "fov = 30.0", "fov = 31.0"),
        ("own.toml", "0.5", "0.1"),
    ],
)
def test_a_case_that_is_drawn_otherwise_under_the_same_name_is_told(
    measured, shadeproof, name, before, after
):
    changed = measured.parent / name
    changed.write_text(changed.read_text().replace(before, after))
    code, out, err = shadeproof("plan", "--max-error", 0.5, "--bench", measured)
    assert (code, out) == (2, "") and "as it was measured; run `shadeproof bench` anew" in err


def environment(path, value=1.0):
    """Write a tiny environment, and return its path."""
    path.parent.mkdir(exist_ok=True)
    save_frame(Frame(np.full((4, 8, 3), value, np.float32)), path)
    return path


def test_another_environment_of_the_same_name_is_refused(measured, shadeproof, tmp_path):
    own = environment(tmp_path / "mine" / "studio.exr")
    words = ("--max-error", 0.5, "--bench", measured, "--environment", own)
    code, out, err = shadeproof("plan", *words)
    assert (code, out, len(err.splitlines())) == (2, "", 1)
    assert "makes another case 'ball.studio." in err and "rename the file" in err


def test_an_environment_that_cannot_be_drawn_is_refused(measured, shadeproof, tmp_path):
    broken = environment(tmp_path / "broken.exr", np.nan)
    words = ("--max-error", 0.5, "--bench", measured, "--environment", broken)
    code, out, err = shadeproof("plan", *words)
    assert (code, out, len(err.splitlines())) == (2, "", 1) and "NaN" in err


def test_a_plan_never_overwrites_the_suite_it_was_made_of(measured, shadeproof):
    suite = measured.parent / "suite.toml"
    words = ("--max-error", 0.5, "--bench", measured, "--to", suite)
    code, _, err = shadeproof("plan", *words)
    assert code == 2 and "is the suite that was measured" in err
    assert suite.read_text() == SUITE


@pytest.mark.parametrize(("option", "how"), [("--max-error", "gate"), ("--max-ms", "compare")])
def test_the_command_that_checks_a_plan_can_check_it(measured, shadeproof, tmp_path, option, how):
    to = tmp_path / "plan.toml"
    out = shadeproof("plan", option, 3, "--bench", measured, "--to", to)[1]
    assert f"`shadeproof {how} --suite" in out
    assert bool(load_suite(str(to))[0].budget) == (how == "gate")


def test_gate_takes_a_plan(measured, shadeproof, tmp_path):
    to, out = tmp_path / "plan.toml", tmp_path / "out"
    assert shadeproof("plan", "--max-error", 0.7, "--bench", measured, "--to", to)[0] == 0
    only = ("--filter", "ball.studio.gold.weight=1", "--out", out)
    assert shadeproof("compare", "--suite", to, *only)[0] == 0
    (row,) = json.loads((out / "results.json").read_text())["rows"]
    assert (row["technique"], row["truth"], row["budget"]) == (
        "paper-noaa",
        "global",
        {"energy_local": 0.7},
    )
