"""`shadeproof bench` on a tiny suite, and the parts that it is made of."""

import json
import math
import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import moderngl
import numpy as np
import pytest
from rich.console import Console

from renderer.context import context
from reports.noise import Estimate
from reports.run.bench import memory
from reports.run.bench.errors import Judged, pooled
from reports.run.bench.measured import PICTURES, Measured, lacking, measure, timed
from reports.run.bench.way import Cost, Way, changed
from reports.speed.points import Bench, Point, load_bench
from reports.speed.table import print_bench
from scenes.schema import Material
from scenes.suite import expand, load_suite
from tests.reports import benches

SUITE = """
description = "One small bunny."
techniques = ["paper", "sampled@4"]
truths = ["global"]
[reference]
samples_per_batch = 16
max_samples = 128
[[run]]
scene = "single"
environments = ["studio"]
resolution = [64, 64]
"""
ROOT = Path(__file__).resolve().parents[2]
CHANGES = {"light", "material", "weight", "geometry"}


@pytest.fixture(scope="module")
def suite(tmp_path_factory):
    """The path of the tiny suite."""
    path = tmp_path_factory.mktemp("suite") / "small.toml"
    path.write_text(SUITE)
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


@pytest.fixture
def case(suite):
    (entry,) = expand(*load_suite(str(suite)))
    return entry.case


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
    assert [p.samples for p in family(found, "path traced")] == [1, 2, 4, 8, 16, 36, 64]
    assert [p.samples for p in family(found, "denoised")] == [1, 4, 16, 64]
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


class Scripted(Way):
    """A way whose frames take what a script says, and that remembers their seeds."""

    family = "path traced"

    def __init__(self, name, seconds, noisy, calls):
        self.name, self.seconds, self.noisy, self.calls = name, seconds, noisy, calls

    def frame(self, seed):
        self.calls.append((self.name, seed))
        return self.seconds

    def picture(self):
        return np.ones((64, 64, 3), np.float32)

    def cost(self, frame):
        return Cost()


@pytest.fixture
def scripted(case, monkeypatch):
    """The calls of one long and noisy and one short and still way in 4 rounds, and the result."""
    exact = Judged(*[Estimate(0.1)] * 3)
    monkeypatch.setattr("reports.run.bench.measured.judged", lambda *_: exact)
    calls = []
    ways = [Scripted("long", 1.0, True, calls), Scripted("short", 0.01, False, calls)]
    return calls, measure(case, ways, None, 4, lambda _: None)


def test_ways_take_turns_and_short_frames_are_warmed(scripted):
    calls, (long, short) = scripted
    assert long.seconds == [1.0] * 4 and short.seconds == [0.01] * 4
    order = [name for name, _ in calls[2:]]  # after each has drawn once
    assert order[:3] == ["long", "long", "short"] or order[:4] == ["long", "long", "short", "short"]
    assert order.count("short") == 8 and order.count("long") == 5
    assert order[-1] == "long"  # the first of the odd rounds is the other one


def test_noisy_ways_are_judged_on_several_pictures_of_different_seeds(scripted):
    calls, (long, short) = scripted
    assert [len(m.judged["bunny"]) for m in (long, short)] == [PICTURES, 1]
    seeds = [seed for name, seed in calls if name == "long"]
    assert len(set(seeds)) >= 4


def test_times_are_told_by_median_and_quartiles():
    told = timed([5.0, 1, 2, 3, 4])
    assert (told.low, told.median, told.high, told.frames) == (2, 3, 4, 5)


def test_pictures_share_the_truth_so_its_noise_does_not_average_out():
    alike = pooled([Estimate(0.5, 0.1, 7)] * 4)
    assert alike.value == 0.5 and alike.se == pytest.approx(0.1) and alike.dof == pytest.approx(7)
    apart = pooled([Estimate(0.4, 0.0, 7), Estimate(0.6, 0.0, 7)])
    assert apart.se == pytest.approx(0.1) and apart.dof == pytest.approx(1)
    assert pooled([Estimate(0.5, 0.2, 3)]) == Estimate(0.5, 0.2, 3)


def test_growth_is_the_peak_and_not_what_is_left():
    with memory.growing() as growth:
        np.ones(1 << 23).sum()  # 64 MiB, freed
    assert 60e6 < growth.peak < 90e6
    assert growth.left < 20e6


def test_growth_is_unknown_where_the_system_tells_nothing(tmp_path, monkeypatch):
    monkeypatch.setattr(memory, "STATUS", tmp_path / "none")
    with memory.growing() as growth:
        pass
    assert math.isnan(growth.peak) and math.isnan(growth.left)


def test_held_bytes_are_those_of_live_objects():
    gl, before = context(), memory.held_bytes()
    plain = gl.texture((64, 32), 4, dtype="f4")
    target = gl.renderbuffer((10, 10), 4, samples=4, dtype="f2")
    buffer = gl.buffer(reserve=1000)
    sizes = 64 * 32 * 16 + 10 * 10 * 8 * target.samples + 1000
    assert memory.held_bytes() - before == sizes
    plain.build_mipmaps()
    plain.filter = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)
    assert memory.held_bytes() - before == pytest.approx(sizes + 64 * 32 * 16 / 3)
    for held in (plain, target, buffer):
        held.release()
    assert memory.held_bytes() == before


def test_a_change_of_weight_keeps_both_lobes(case):
    for step in range(4):
        materials = [o.material for o in changed(case, "weight", step).objects]
        assert all(0 < m.weight < 1 and m.masking_weight == m.weight for m in materials)
    assert len({changed(case, "weight", step) for step in range(4)}) == 4


@pytest.mark.parametrize("change", sorted(CHANGES))
def test_parameters_that_are_set_change_the_path_traced_picture(case, change):
    from reports.run.bench.path_traced import Tracer, _new_parameters, mi

    tracer = Tracer(changed(case, "weight"))
    before = tracer.draw(4, 0)
    params = mi.traverse(tracer.scene)
    for name, value in _new_parameters(tracer, change, 3).items():
        params[name] = value
    params.update()
    after = tracer.draw(4, 0)
    assert np.isfinite(after).all() and (before != after).any()
    if change == "light":
        assert after == pytest.approx(before * (1 + 3 / 8), rel=1e-3)


def test_guides_are_reflectance_and_normals_on_the_object_and_nothing_beside_it(case):
    from reports.run.bench.denoised import DenoisedTracer

    traced = DenoisedTracer(case).traced(16, 0).numpy()
    middle, corner = traced[40, 32], traced[0, 0]
    assert middle[3:6] == pytest.approx(case.objects[0].material.specular_f0, rel=1e-5)
    assert np.linalg.norm(middle[6:9]) == pytest.approx(1, abs=0.2)
    assert (corner[3:] == 0).all() and (corner[:3] > 0).any()


def test_the_reflectance_of_plastic_is_what_both_lobes_send_back(case):
    from reports.run.bench.denoised import reflectance

    material = Material(albedo=(0.5, 0.2, 0.99), roughness=0.5, metallic=0, f0=0.04)
    plastic = case.objects[0].model_copy(update={"material": material})
    assert reflectance(plastic) == pytest.approx([0.54, 0.24, 1])


def test_without_the_denoiser_one_line_says_what_is_left_out(monkeypatch):
    from reports.run.bench.denoised import unavailable

    assert unavailable() == ""
    monkeypatch.setitem(sys.modules, "mitsuba_oidn", None)
    assert "mitsuba-oidn" in unavailable() and "shadeproof[denoise]" in unavailable()


def test_samples_are_those_that_the_sampler_takes_and_fit_the_time(case):
    from reference.settings import rounded_samples
    from reports.run.bench.path_traced import SAMPLES, samples_for

    assert all(rounded_samples(k) == k for k in SAMPLES)
    large = case.model_copy(update={"width": 1920, "height": 1080})
    assert samples_for(large) == [1, 2, 4, 8]


def test_the_ratio_at_full_size_is_told(capsys):
    points = [
        Point(
            case="c", environment="e", width=1920, height=1080, family=kind, name=name,
            samples=samples, frame=timed([seconds] * 3),
        )
        for kind, name, samples, seconds in (
            ("real-time", "paper", 0, 0.1),
            ("path traced", "Mitsuba 1", 1, 0.4),
        )
    ]  # fmt: skip
    bench = Bench(
        suite="s", suite_path="s.toml", command="", created="", seconds=1, provenance={},
        points=points,
    )  # fmt: skip
    print_bench(bench, Console(width=160))
    assert "1920x1080 ratio to Mitsuba 1 sample, c: paper 0.250" in capsys.readouterr().out


def test_the_tables_tell_apart_cases_with_long_names_and_leave_out_unknown_errors(capsys):
    names = [f"single.courtyard.copper.weight=0.{n}.roughness=0.5" for n in (25, 75)]
    errors = [benches.error("seen", 0.1, 0.2), benches.error("away", math.nan, math.nan)]
    points = [benches.point(case=n, errors=errors) for n in names]
    points += [benches.point(case=n, name="paper-noaa", errors=errors[1:]) for n in names]
    needs = [benches.equal(case=n, object="seen") for n in names]
    print_bench(benches.small_bench(points=points, equal=needs), Console(width=160))
    told = "".join(capsys.readouterr().out.split())
    assert all(told.count(n) == 2 for n in names), "each in both tables"
    assert "10.00%0.2000" in told and told.count("unknownunknown") == 2 and "nan%" not in told


def test_an_object_without_errors_is_named_once(case):
    def seen(name, problem):
        there, away = (Judged(*[Estimate(0, 0, 1)] * 3, p) for p in ("", problem))
        return Measured(SimpleNamespace(name=name), [], {"ball": [there], "moon": [away, away]})

    both = [seen("paper", "is out of the picture"), seen("Mitsuba 1", "is out of the picture")]
    assert lacking(case, both) == ["single.studio, errors of moon: is out of the picture"]
    alone = [both[0], seen("Mitsuba 1", "")]
    assert lacking(case, alone) == [f"{lacking(case, both)[0]} (paper)"]


def test_errors_that_are_unknown_are_told_with_the_reason(case):
    known, unknown = Estimate(0.1, 0.01, 9), Estimate(math.nan, math.nan, 0)
    black = Measured(SimpleNamespace(name="paper"), [], {"ball": [Judged(known, *[unknown] * 2)]})
    (line,) = lacking(case, [black])
    assert "errors of ball: local energy and SSIM unknown: the truth is black" in line


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


INTERRUPTED = """
import os
from multiprocessing import forkserver
from reports.run.bench import kernels
try:
    with kernels.kept_apart():
        forkserver.ensure_running()
        print(*os.listdir(os.environ["TMPDIR"]), flush=True)
        raise KeyboardInterrupt
except KeyboardInterrupt:
    os._exit(130)  # as reports/cli/main.py
"""


def test_an_interrupted_bench_leaves_no_temporary_folder(tmp_path):
    env = os.environ | {"TMPDIR": str(tmp_path)}
    ran = subprocess.run(
        [sys.executable, "-c", INTERRUPTED], cwd=ROOT, env=env, capture_output=True, text=True
    )
    assert ran.returncode == 130 and not ran.stderr
    assert {name.split("-")[0] for name in ran.stdout.split()} == {"shadeproof", "pymp"}
    assert not list(tmp_path.iterdir())


STOPPED = """
import os, signal, sys, threading, time
from pathlib import Path
from reports.run.bench.realtime import started_anew
from scenes.suite import expand, load_suite
(entry,) = expand(*load_suite(sys.argv[1]))
def stop():
    if sys.argv[2] == "starts":
        time.sleep(0.2)
    while sys.argv[2] == "draws" and not list(Path(os.environ["TMPDIR"]).glob("tmp*")):
        time.sleep(0.01)
    os.killpg(0, signal.SIGINT)
threading.Thread(target=stop, daemon=True).start()
try:
    started_anew(entry.case, "paper")
except BaseException:
    os._exit(130)
"""


@pytest.mark.parametrize("moment", ["starts", "draws"])
def test_a_technique_that_is_interrupted_leaves_no_traceback(suite, tmp_path, moment):
    ran = subprocess.run(
        [sys.executable, "-c", STOPPED, str(suite), moment],
        cwd=ROOT,
        env=os.environ | {"TMPDIR": str(tmp_path)},
        capture_output=True,
        text=True,
        start_new_session=True,
        timeout=60,
    )
    assert (ran.returncode, ran.stderr) == (130, "")
    assert not list(tmp_path.glob("tmp*")), "links to meshes"
