"""`shadeproof bench` on a tiny suite."""

import json
import math
from types import SimpleNamespace

import pytest

from reports.speed.points import Bench, load_bench
from tests.reports.small import BUNNY

CHANGES = {"light", "material", "weight", "geometry"}


@pytest.fixture(scope="module")
def suite(tmp_path_factory):
    """The path of the tiny suite."""
    path = tmp_path_factory.mktemp("suite") / "small.toml"
    path.write_text(BUNNY)
    return path


@pytest.fixture(scope="module")
def ran(shadeproof, suite, tmp_path_factory):
    """Exit code, what was printed, and the folder of a bench."""
    folder = tmp_path_factory.mktemp("bench")
    words = ("--suite", suite, "--out", folder, "--frames", 3)
    # Both have tests of their own, in smaller sizes.
    code, out, err = shadeproof("bench", *words, "--skip", "lobes", "--skip", "growth")
    return SimpleNamespace(code=code, out=out, err=err, folder=folder)


@pytest.fixture(scope="module")
def found(ran):
    assert ran.code == 0, ran.err
    return load_bench(ran.folder / "bench.json")


def family(bench, name):
    return [p for p in bench.points if p.family == name]


def frame_of(bench, equal):
    return next(p.frame.median for p in bench.points if p.name == equal.technique)


def test_a_bench_tells_what_its_cases_do_without_and_what_was_skipped(found):
    told = {x.what for x in found.left_out if x.exact}
    assert {"paper: Beckmann lobe", "sampled@4: diffuse lobe"} <= told  # copper, GGX alone
    assert not found.lobes and not found.growths
    assert {"lobes: --skip lobes", "growth: --skip growth"} <= set(found.skipped)


def test_a_bench_ends_well_and_leaves_its_points(ran, found):
    names = [p.name for p in found.points]
    assert names[:3] == ["paper", "sampled@4", "Mitsuba 1"]
    assert [p.samples for p in family(found, "path traced")] == [1, 2, 4, 8, 16, 36, 64, 144, 256]
    assert [p.samples for p in family(found, "denoised")] == [1, 4, 16, 64, 256]
    for point in found.points:
        assert 0 < point.frame.low <= point.frame.median <= point.frame.high
        assert point.frame.frames == 3
        assert set(point.after) == CHANGES
        assert point.memory > 0
        (error,) = point.errors
        assert error.energy_local.low <= error.energy_local.value <= error.energy_local.high
        assert 0 < error.one_minus_ssim.value < 1
    assert "Mitsuba 64 + OIDN" in ran.out and "bench.html" in ran.out
    assert (ran.folder / "bench.html").stat().st_size > 1000


@pytest.mark.parametrize("name", ["path traced", "denoised"])
def test_more_samples_are_better_and_take_longer(found, name):
    few, *_, many = family(found, name)
    (worse,), (better,) = few.errors, many.errors
    assert better.energy_local.value < worse.energy_local.value / 2
    assert better.one_minus_ssim.value < worse.one_minus_ssim.value / 2
    assert many.frame.median > few.frame.median


def test_a_denoiser_helps(found):
    raw = {p.samples: p for p in family(found, "path traced")}
    for point in family(found, "denoised"):
        assert (
            point.errors[0].one_minus_ssim.value < raw[point.samples].errors[0].one_minus_ssim.value
        )


def test_what_is_made_once_stands_apart_from_frames(found):
    paper = found.points[0]
    assert paper.compilation > 0 and paper.precomputation > 0 and paper.preparation > 0
    assert paper.after["light"] > paper.precomputation
    assert paper.after["weight"] < paper.after["light"] / 2  # maps are shared by all weights
    assert paper.held > 512 * 256 * 16  # a prefiltered map alone
    for point in family(found, "path traced"):
        assert point.precomputation == 0 and point.compilation > 0 and math.isnan(point.held)
        assert point.after["geometry"] > point.frame.median


def test_every_technique_is_held_against_both_families(found):
    told = {(e.technique, e.against, e.figure) for e in found.equal}
    assert len(told) == len(found.equal) == 2 * 2 * 2
    known = [e for e in found.equal if not math.isnan(e.samples.value)]
    assert {e.against for e in known} == {"path traced", "denoised"}
    for e in known:
        assert e.beyond in ("", "above")
        told = not math.isnan(e.samples.low)  # the noise of so small a truth may be unknown
        assert not told or e.samples.low <= e.samples.value <= e.samples.high
        assert e.ratio.value == pytest.approx(e.seconds.value / frame_of(found, e), rel=0.5)


def test_the_schema_in_the_docs_is_the_schema(request):
    documented = json.loads((request.config.rootpath / "docs/bench.schema.json").read_text())
    assert documented == Bench.model_json_schema()


def test_a_filter_without_a_case_ends_in_one_line(shadeproof, tmp_path):
    code, _, err = shadeproof("bench", "--filter", "nothing-here", "--out", tmp_path)
    assert code == 2 and len(err.strip().splitlines()) == 1
    assert not (tmp_path / "bench.json").exists()


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("--frames", 0), "give a number from 3 up"),
        (("--frames", 10**9), "give a number up to 1000"),
        (("--frames", "1e9"), "give a whole number"),
        (("--skip", "growth,lobes"), "'growth'; see `shadeproof bench --help`"),
    ],
)
def test_an_option_that_cannot_be_is_refused_in_one_line(shadeproof, suite, tmp_path, words, told):
    out = tmp_path / "out"
    code, said, err = shadeproof("bench", "--suite", suite, "--out", out, *words)
    assert (code, said, len(err.splitlines())) == (2, "", 1)
    assert err.startswith(f"error: {words[0]}: ") and told in err
    assert not out.exists()
