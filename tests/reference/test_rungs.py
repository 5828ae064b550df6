"""Every truth against Mitsuba's stock integrators, so that none can be wrong in all its batches.

A reference whose every batch is wrong alike closes with itself; only another estimate of the same
light can tell. Here that is Mitsuba's own `direct` and `path` with `independent` samples: no code
of ours but the scene, and for three of the truths the BSDF. Mitsuba has no integrator for light
that nothing stops, but a sphere and a plane cannot stand in their own light: each alone under
`direct` is what the truth `unoccluded` says of it among the others.
"""

import numpy as np
import pytest
from scipy import stats
from scipy.ndimage import binary_erosion

from reference.batches import render_batch, truth_of
from reference.scene_dict import build_scene
from reference.settings import PATH, TRUTHS
from reference.truths import mi, stage
from scenes.suite import expand, load_suite

FAMILY_ERROR = 1e-3  # chance that any of the comparisons below calls equal light unequal
DEFAULT = [entry.case for entry in expand(*load_suite("default"))]
LIGHTS = {case.environment.name: case.environment for case in DEFAULT}
RUNGS = ("unoccluded", "direct", "global", "physical")
BATCHES = 16
OURS, STOCK = 49, 144  # samples per pixel of a batch
SEEN = 0.01  # a bias that must not pass; the errors are up to .15 % of an object's channel


@pytest.fixture(scope="module", params=LIGHTS)
def case(request):
    """A copper sphere on a floor by a red wall, under a light of the default suite."""
    (contact,) = (entry.case for entry in expand(*load_suite("tiny")))
    copper = next(o.material for o in DEFAULT[0].objects if o.name == "copper")
    sphere, *others = contact.objects
    sphere = sphere.model_copy(update={"material": copper})
    changes = {"environment": LIGHTS[request.param], "objects": (sphere, *others)}
    return contact.model_copy(update=changes)


@pytest.fixture(scope="module")
def ours(case):
    """Light of each object by truth, (BATCHES, objects, 3), as references are traced."""
    found = {}
    for kind in TRUTHS:
        frames = [render_batch(case, kind, OURS, seed) for seed in range(BATCHES)]
        for truth in TRUTHS[kind]:
            found[truth] = np.stack([light(case, truth_of(f, truth).rgb) for f in frames])
    return found


def light(case, picture):
    """The sum over the pixels that show one object alone, (objects, 3)."""
    ids = stage(case, "model").ids
    wholes = (binary_erosion(ids == 1 + k) for k in range(len(case.objects)))
    return np.stack([picture[whole].sum(axis=0) for whole in wholes])


def stock(case, truth):
    """The same by Mitsuba's own integrators."""
    if truth != "unoccluded":
        return rendered(case, case, truth)
    alone = (case.model_copy(update={"objects": (o,)}) for o in case.objects)
    lights = [rendered(case, one, "direct") for one in alone]
    return np.stack([found[:, k] for k, found in enumerate(lights)], axis=1)


def rendered(case, drawn, truth):
    """Light of a case's objects, (BATCHES, objects, 3), where `drawn` holds all or one of them."""
    scene, _ = build_scene(drawn, physical=truth == "physical")
    integrator = mi.load_dict({"type": "direct"} if truth == "direct" else PATH)
    seeds = range(1000, 1000 + BATCHES)
    runs = (mi.render(scene, integrator=integrator, seed=seed, spp=STOCK) for seed in seeds)
    return np.stack([light(case, run.numpy()) for run in runs])


def unequal(a, b):
    """Whether some object's light differs in some channel, by Welch's t at the family's level."""
    tests = len(LIGHTS) * len(RUNGS) * a[0].size
    p = stats.ttest_ind(a, b, axis=0, equal_var=False).pvalue
    return (p < 1 - (1 - FAMILY_ERROR) ** (1 / tests)).any()


@pytest.mark.long
@pytest.mark.parametrize("truth", RUNGS)
def test_every_truth_has_the_light_of_stock_integrators(case, ours, truth):
    theirs = stock(case, truth)
    assert not unequal(ours[truth], theirs)
    for bias in (1 - SEEN, 1 + SEEN):  # or the test says nothing
        assert unequal(bias * ours[truth], theirs)
