"""Error by cause: causes that are known come back, their sum can fail, and absence has a size."""

import numpy as np
import pytest

from reports.compare import Truth, compare
from reports.ladder import RUNGS, Drawn, ladder
from reports.metrics import energy
from reports.metrics.energy import BLOCK
from reports.results import Row
from scenes.frame import Frame
from scenes.schema import Camera, Case, Environment, Material, Object

HEIGHT, WIDTH, SIDE = 96, 128, 96  # the object covers SIDE columns: 6 x 6 blocks
BATCHES, NOISE = 8, 0.02
ALL = ("integration", "occlusion", "interreflection", "model")
CASE = Case(
    id="made",
    scene="made",
    environment=Environment(name="none", path="none.hdr"),
    camera=Camera(origin=(0, -3, 0), target=(0, 0, 0), fov=20),
    width=WIDTH,
    height=HEIGHT,
    objects=(
        Object(
            name="thing",
            mesh="sphere",
            material=Material(name="m", albedo=(0.5, 0.5, 0.5), roughness=0.5, metallic=0),
        ),
    ),
)
THING = CASE.objects[0]
IDS = np.zeros((HEIGHT, WIDTH), np.uint8)
IDS[:, :SIDE] = 1


def blocky(seed, mean, spread=0.05):
    """Light that differs from block to block, (H, W, 3), alike in all channels."""
    rng = np.random.default_rng(seed)
    rough = rng.normal(mean, spread, (HEIGHT // BLOCK, WIDTH // BLOCK))
    return np.repeat(np.kron(rough, np.ones((BLOCK, BLOCK)))[..., None], 3, axis=2)


# What each rung adds to the one below: all shadows, all bounces, another model.
ADDED = {
    "unoccluded": blocky(1, 1.2),
    "direct": blocky(2, -0.4, 0.2),
    "global": blocky(3, 0.25, 0.1),
    "physical": blocky(4, -0.1),
}
TRUTHS = dict(zip(ADDED, np.cumsum(list(ADDED.values()), axis=0), strict=True))  # each rung's light
WRONG = blocky(5, 0.08)  # the candidate's integration error


def batches(mean, diffuse=0.0, seed=0, noise=NOISE):
    """Frames around a mean; `diffuse` is the diffuse lobe's share of every pixel's light."""
    rng = np.random.default_rng(seed)
    made = []
    for _ in range(BATCHES):
        rgb = (mean * rng.normal(1, noise, mean.shape)).astype(np.float32)
        made.append(Frame(rgb, IDS, layers={"diffuse": np.float32(diffuse) * rgb}))
    return made


def traced(rungs=RUNGS, diffuse=0.0, seed=0):
    """Batches by truth; the first three share their noise, as they share their paths."""
    return {r: batches(TRUTHS[r], diffuse, seed + 9 * (r == "physical")) for r in rungs}


def light(picture):
    """The light on the object over that of the last rung."""
    on = IDS > 0
    return picture[on].sum() / TRUTHS["physical"][on].sum()


def row(truth, ssim):
    """A row with a SSIM and nothing else."""
    return Row(
        case="made", scene="made", environment="none", object="thing", material="m",
        roughness=0.5, metallic=0, weight=1, weight_g=1, technique="paper",
        picture="paper", truth=truth, ssim=ssim, ssim_se=0.001, ssim_dof=50,
    )  # fmt: skip


def climbed(drawn, truths, rows=()):
    """The ladder of one picture for all truths, or of one for each."""
    by_truth = dict.fromkeys(truths, drawn) if isinstance(drawn, Drawn) else drawn
    return ladder(CASE, THING, "paper", by_truth, truths, rows)


def named(found):
    return {c.name: c for c in found.causes}


def holds(figure, value):
    """Whether a figure is a value within three halves of its interval."""
    return abs(figure.value - value) <= 1.5 * (figure.high - figure.low) / 2 + 1e-6


@pytest.mark.parametrize("seed", range(5))
def test_known_causes_come_back(seed):
    found = climbed(Drawn(TRUTHS["unoccluded"] + WRONG), traced(seed=seed))
    causes, expected = named(found), {"integration": WRONG}
    expected |= {n: -ADDED[r] for n, r in zip(ALL[1:], RUNGS[1:], strict=True)}
    assert list(causes) == list(ALL)
    error = TRUTHS["unoccluded"] + WRONG - TRUTHS["physical"]
    on = IDS > 0
    squares = (error / TRUTHS["physical"])[on] ** 2
    root = np.sqrt(squares.mean())
    for name, step in expected.items():
        assert holds(causes[name].energy, light(step)), name
        assert causes[name].energy.high - causes[name].energy.low < 0.01
        share = (step * error / TRUTHS["physical"] ** 2)[on].mean() / root
        assert holds(causes[name].local, share), name
        assert causes[name].local.high - causes[name].local.low < 0.02
    assert holds(found.total.energy, light(error))
    assert holds(found.total.local, root)


@pytest.mark.parametrize("rungs", [RUNGS, RUNGS[:3], RUNGS[:2]])
def test_causes_sum_to_the_total(rungs):
    found = climbed(Drawn(TRUTHS["unoccluded"] + WRONG), traced(rungs))
    assert found.closes
    assert found.truth == rungs[-1]
    for figure in ("energy", "local"):
        gap = getattr(found, f"{figure}_gap")
        summed = sum(getattr(c, figure).value for c in found.causes)
        total = getattr(found.total, figure).value
        assert gap.value == pytest.approx(summed - total, abs=1e-9)
        assert gap.value != 0  # from different batches, so it cannot be nought
        assert abs(gap.value) < 0.01


@pytest.mark.parametrize("rung", RUNGS)
def test_a_rung_whose_batches_disagree_keeps_the_sum_from_closing(rung):
    truths = traced()
    other = batches(1.02 * TRUTHS[rung], seed=3)
    truths[rung] = [other[i] if i % 2 else b for i, b in enumerate(truths[rung])]
    found = climbed(Drawn(TRUTHS["unoccluded"] + WRONG), truths)
    assert not found.closes
    assert abs(found.energy_gap.value) > 0.01


def test_gaps_are_covered_by_their_intervals():
    inside = []
    for seed in range(0, 600, 20):
        found = climbed(Drawn(TRUTHS["unoccluded"] + WRONG), traced(seed=seed))
        assert found.closes
        inside += [g.low <= 0 <= g.high for g in (found.energy_gap, found.local_gap)]
    assert 0.85 <= np.mean(inside) <= 1  # of 60, 57 on average and 51 at the least


@pytest.mark.parametrize("lacking", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("gain", [1.0, 1.3])
def test_what_is_missing_has_its_size_whatever_the_gain(lacking, gain):
    kept = (1 - lacking) * (ADDED["direct"] + ADDED["global"])
    picture = gain * TRUTHS["unoccluded"] + kept + blocky(6, 0, 0.01)
    found = climbed(Drawn(picture), traced())
    assert list(found.missing) == ["occlusion", "interreflection"]
    for figure in found.missing.values():
        assert holds(figure, lacking)
        assert figure.high - figure.low < 0.4


def test_shadows_and_bounces_can_be_missing_apart():
    missing = climbed(Drawn(TRUTHS["direct"] + blocky(6, 0, 0.01)), traced()).missing
    assert holds(missing["occlusion"], 0) and holds(missing["interreflection"], 1)


def test_what_is_missing_takes_full_transport_to_tell():
    assert climbed(Drawn(TRUTHS["unoccluded"]), traced(RUNGS[:2])).missing == {}


def test_a_metal_has_no_diffuse_part():
    picture = TRUTHS["unoccluded"] + WRONG
    for cause in climbed(Drawn(picture, specular=picture), traced()).causes:
        assert (cause.diffuse.value, cause.diffuse.low, cause.diffuse.high) == (0, 0, 0)


def test_diffuse_light_is_told_apart():
    picture = TRUTHS["unoccluded"] + WRONG
    specular = picture - 0.3 * TRUTHS["unoccluded"] - 0.75 * WRONG
    found = climbed(Drawn(picture, specular), traced(diffuse=0.3))
    causes = named(found)
    assert holds(causes["integration"].diffuse, 0.75 * light(WRONG))
    assert holds(causes["occlusion"].diffuse, -0.3 * light(ADDED["direct"]))
    own = 0.3 * (TRUTHS["unoccluded"] - TRUTHS["physical"]) + 0.75 * WRONG
    assert holds(found.total.diffuse, light(own))


def test_diffuse_light_of_a_picture_alone_is_unknown_but_the_truths_is_not():
    found = climbed(Drawn(TRUTHS["direct"]), traced(diffuse=0.3))
    causes = named(found)
    assert causes["integration"].diffuse is None
    assert found.total.diffuse is None
    assert holds(causes["occlusion"].diffuse, -0.3 * light(ADDED["direct"]))


def test_integration_is_split_by_the_maps_that_are_refined():
    parts = {"irradiance map": blocky(7, 0.05), "table": blocky(8, -0.03)}
    picture = TRUTHS["unoccluded"] + WRONG
    refined = {name: picture - part for name, part in parts.items()}
    # Diffuse light is .3 of the truth, and in the candidate 1.1 times that and the map's error.
    diffuse = 0.3 * 1.1 * TRUTHS["unoccluded"] + parts["irradiance map"]
    causes = named(climbed(Drawn(picture, picture - diffuse, refined), traced(diffuse=0.3)))
    kd = 0.03 * TRUTHS["unoccluded"]
    expected = parts | {"kd at n·v": kd, "prefilter": WRONG - sum(parts.values()) - kd}
    for name, part in expected.items():
        assert causes[name].parent == "integration"
        assert holds(causes[name].energy, light(part)), name
    assert causes["table"].diffuse.value == causes["prefilter"].diffuse.value == 0
    for figure in ("energy", "local"):
        own = sum(getattr(causes[name], figure).value for name in expected)
        assert own == pytest.approx(getattr(causes["integration"], figure).value, abs=1e-9)


def test_a_table_that_is_the_materials_own_is_no_part():
    picture = TRUTHS["unoccluded"] + WRONG
    drawn = Drawn(picture, 0.7 * picture, {"irradiance map": picture})
    causes = named(climbed(drawn, traced(diffuse=0.3)))
    assert [n for n, c in causes.items() if c.parent] == [
        "irradiance map", "kd at n·v", "prefilter",
    ]  # fmt: skip


def test_the_model_is_split_in_its_fixed_order():
    between = {"Fresnel": blocky(11, -0.05), "kd": blocky(12, 0.04)}
    truths, reached = traced(), TRUTHS["global"]
    for i, (name, added) in enumerate(between.items()):
        reached = reached + added
        truths[name] = batches(reached, seed=20 + i)
    causes = named(climbed(Drawn(TRUTHS["unoccluded"]), truths))
    assert [n for n, c in causes.items() if c.parent == "model"] == ["Fresnel", "kd", "masking"]
    masking = ADDED["physical"] - sum(between.values())
    for name, added in (between | {"masking": masking}).items():
        assert holds(causes[name].energy, -light(added)), name


def test_steps_of_ssim_start_from_a_perfect_picture():
    rows = [row(t, value) for t, value in zip(RUNGS, (0.95, 0.8, 0.85, 0.83), strict=True)]
    found = climbed(Drawn(TRUTHS["unoccluded"]), traced(), rows)
    steps = [c.ssim.value for c in found.causes]
    assert steps == pytest.approx([-0.05, -0.15, 0.05, -0.02])
    assert found.total.ssim.value == pytest.approx(-0.17)


@pytest.mark.parametrize(
    "rungs",
    [("unoccluded",), ("global",), ("direct", "global"), ("unoccluded", "global", "physical"), ()],
)
def test_a_ladder_with_a_rung_missing_is_none(rungs):
    assert climbed(Drawn(TRUTHS["direct"]), traced(rungs)) is None


def test_a_ladder_that_cannot_be_climbed_is_none():
    lost = TRUTHS["direct"].copy()
    lost[0, 0, 0] = np.nan
    assert climbed(Drawn(lost), traced()) is None
    assert climbed(Drawn(TRUTHS["direct"][:50]), traced()) is None
    few = {t: b[:3] for t, b in traced().items()}
    assert climbed(Drawn(TRUTHS["direct"]), few) is None


@pytest.mark.parametrize("seed", range(6))
def test_a_right_candidate_has_no_shares_and_its_sum_still_closes(seed):
    """Local energy is then nothing but noise, whose square may come out below zero."""
    found = climbed(Drawn(TRUTHS["physical"]), traced(seed=seed))
    assert found.closes
    assert abs(found.total.energy.value) < 0.002


@pytest.mark.parametrize("dark", [None, 0, 2], ids=["lit", "a dark block", "another channel's"])
def test_local_energy_is_the_rows_where_there_is_no_noise(dark):
    """The worst channel is that of the row, though a block of it has no light to divide by."""
    truths = {r: TRUTHS[r].copy() for r in RUNGS}
    candidate = truths["global"] * [1.1, 0.8, 1.0]
    if dark is not None:
        for light in truths.values():
            light[:BLOCK, :BLOCK, dark] = 0
        candidate[:BLOCK, :BLOCK, dark] = 4.0
    frames = {r: batches(light, seed=1, noise=0) for r, light in truths.items()}
    candidate = candidate.astype(np.float32)
    total = climbed(Drawn(candidate), frames).total.local.value
    truth = Truth(CASE, "physical", frames["physical"], {"thing": 1.0})
    figures = compare(CASE, THING, Frame(candidate, IDS), truth, [energy.figures])
    assert total == pytest.approx(figures["energy_local"], rel=1e-9)


# A candidate with switches: what is wrong with its picture against each truth.
WRONGS = {t: blocky(30 + k, 0.05 * (k - 1)) for k, t in enumerate(RUNGS)}


def matched(wrongs=WRONGS, specular=None):
    """A picture for each truth, wrong as said; `specular` is the other lobes' part of it."""
    wholes = {t: TRUTHS[t] + wrong for t, wrong in wrongs.items()}
    return {t: Drawn(w, None if specular is None else specular(w)) for t, w in wholes.items()}


@pytest.mark.parametrize("seed", range(3))
def test_causes_of_a_candidate_with_switches_are_the_steps_of_its_own_errors(seed):
    found = climbed(matched(), traced(seed=seed))
    causes, wrongs = named(found), list(WRONGS.values())
    steps = [wrongs[0], *np.diff(wrongs, axis=0)]
    error, last, on = wrongs[-1], TRUTHS["physical"], IDS > 0
    root = np.sqrt(((error / last)[on] ** 2).mean())
    assert found.switched == ["occlusion", "interreflection", "model"]
    for name, step in zip(ALL, steps, strict=True):
        assert holds(causes[name].energy, light(step)), name
        assert holds(causes[name].local, (step * error / last**2)[on].mean() / root), name
    assert holds(found.total.energy, light(error)) and holds(found.total.local, root)


@pytest.mark.parametrize("rungs", [RUNGS, RUNGS[:3], RUNGS[:2]])
def test_causes_of_a_candidate_with_switches_sum_to_the_total(rungs):
    found = climbed(matched(), traced(rungs))
    assert found.closes
    for figure in ("energy", "local"):
        summed = sum(getattr(c, figure).value for c in found.causes)
        gap = summed - getattr(found.total, figure).value
        assert getattr(found, f"{figure}_gap").value == pytest.approx(gap, abs=1e-9)
        assert 0 < abs(gap) < 0.01


def test_a_rung_that_the_candidate_draws_right_leaves_no_error_to_the_next():
    right = dict.fromkeys(RUNGS, 0 * WRONG)
    for name, cause in named(climbed(matched(right), traced())).items():
        assert holds(cause.energy, 0), name
    late = right | {"global": WRONG, "physical": WRONG}
    causes = named(climbed(matched(late), traced()))
    assert holds(causes["interreflection"].energy, light(WRONG))
    for name in ("integration", "occlusion", "model"):
        assert holds(causes[name].energy, 0), name


def test_a_switch_that_changes_nothing_changes_no_cause():
    picture = TRUTHS["unoccluded"] + WRONG
    one, apart = Drawn(picture), {t: Drawn(picture.copy()) for t in RUNGS}
    without, found = climbed(one, traced()), climbed(apart, traced())
    assert (without.switched, found.switched) == ([], ["occlusion", "interreflection", "model"])
    for a, b in zip(without.causes, found.causes, strict=True):
        assert a.energy.value == pytest.approx(b.energy.value, abs=1e-12)
        assert a.local.value == pytest.approx(b.local.value, abs=1e-12)
    for figure in found.missing.values():
        assert (figure.value, figure.low, figure.high) == (1, 1, 1)


def test_what_a_switch_draws_is_held_against_what_it_should():
    """However wrong the rest of the picture is: the fit of a picture alone would be misled."""
    wholes = [3 * TRUTHS["unoccluded"]]
    wholes.append(wholes[0] + 0.8 * ADDED["direct"])
    wholes.append(wholes[1] + 0.6 * ADDED["global"])
    drawn = {t: Drawn(w) for t, w in zip(RUNGS[:3], wholes, strict=True)}
    found = climbed(drawn, traced(RUNGS[:3]))
    for name, share in {"occlusion": 0.2, "interreflection": 0.4}.items():
        assert holds(found.missing[name], share)
        assert found.missing[name].high - found.missing[name].low < 0.05


def test_a_candidate_with_shadows_alone_lacks_all_light_between_surfaces():
    shadowed = Drawn(TRUTHS["direct"])
    drawn = dict.fromkeys(RUNGS, shadowed) | {"unoccluded": Drawn(TRUTHS["unoccluded"])}
    found = climbed(drawn, traced())
    assert found.switched == ["occlusion"]
    assert holds(found.missing["occlusion"], 0) and found.missing["interreflection"].value == 1
    assert holds(named(found)["interreflection"].energy, -light(ADDED["global"]))


def test_diffuse_light_of_a_candidate_with_switches_is_told_apart():
    """Diffuse light is .3 of every truth, and .4 of every picture."""
    found = climbed(matched(specular=lambda whole: 0.6 * whole), traced(diffuse=0.3))
    causes, before = named(found), 0
    for name, truth in zip(ALL, RUNGS, strict=True):
        error = 0.4 * (TRUTHS[truth] + WRONGS[truth]) - 0.3 * TRUTHS[truth]
        assert holds(causes[name].diffuse, light(error - before)), name
        before = error
    assert holds(found.total.diffuse, light(before))
    half = matched(specular=lambda whole: 0.6 * whole)
    half["direct"] = Drawn(half["direct"].whole)
    causes = named(climbed(half, traced(diffuse=0.3)))
    assert [n for n, c in causes.items() if c.diffuse is None] == ["occlusion", "interreflection"]


def test_parts_of_the_model_are_what_a_candidate_that_draws_it_is_wrong_by():
    between = {"Fresnel": blocky(11, -0.05), "kd": blocky(12, 0.04)}
    truths, light_of = traced(), dict(TRUTHS)
    for i, (name, added) in enumerate(between.items()):
        light_of[name] = light_of["global" if not i else "Fresnel"] + added
        truths[name] = batches(light_of[name], seed=20 + i)
    wrong = {"global": 0.1, "Fresnel": 0.12, "kd": 0.07, "physical": 0.08}
    drawn = {t: Drawn(light_of[t] + wrong.get(t, 0.1)) for t in truths}
    causes = named(climbed(drawn, truths))
    each = np.ones_like(WRONG)
    for name, step in {"Fresnel": 0.02, "kd": -0.05, "masking": 0.01, "model": -0.02}.items():
        assert holds(causes[name].energy, light(step * each)), name
