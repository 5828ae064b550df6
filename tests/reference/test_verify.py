"""A stored reference that no longer holds is found, and a sound one is not refused."""

from dataclasses import replace

import numpy as np
import pytest

from reference import verify as module
from reference.batches import Task, render_batch, trace_batch
from reference.store import Store
from reference.verify import FAMILY_ERROR, FRESH, compare, verify
from scenes.schema import Object
from scenes.suite import Sampling
from tests.reference.cases import metal, plastic

FEW = Sampling(samples_per_batch=16, max_samples=320)
SKY = np.random.default_rng(8).uniform(0, 2, (32, 64, 3))
SKY[8, 20:22] = 200  # a small lamp, as interiors have


@pytest.fixture(scope="module")
def pool():
    """Independent batches of two objects, made once."""
    return {}


@pytest.fixture
def scene(make_case):
    """A rough and a smooth ball side by side."""
    left = Object(name="rough", mesh="sphere", position=(-1.1, 0, 0), material=plastic())
    right = Object(name="smooth", mesh="sphere", position=(1.1, 0, 0), material=metal(0.2))
    return make_case(SKY, objects=(left, right), width=64, height=32)


@pytest.fixture
def batches(pool, scene):
    if not pool:
        pool["all"] = [render_batch(scene, "model", 16, 1000 + seed) for seed in range(40)]
    return pool["all"]


def scaled(frame, ids, factor):
    """The frame with some pixels too bright, in every picture that it holds."""
    layers = {n: np.where(ids[..., None], p * factor, p) for n, p in frame.layers.items()}
    return replace(
        frame, rgb=np.where(ids[..., None], frame.rgb * factor, frame.rgb), layers=layers
    )


def judged(scene, old, new):
    """What `verify` says of one reference that is all there is."""
    objects, blocks = compare(scene, old, new)
    return module._check("x", "model", 8, 8, objects, blocks, len(objects.p), len(blocks.p))


def draws(batches, count, seed=0):
    """Two sets of eight, at random."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        order = rng.permutation(len(batches))
        yield [batches[k] for k in order[:8]], [batches[k] for k in order[8:16]]


def test_sound_references_agree(scene, batches):
    # 30 draws of one pool; at the promised rate one false alarm comes in 33 runs of this test.
    checks = [judged(scene, old, new) for old, new in draws(batches, 30)]
    assert all(c.agrees for c in checks)
    # And the odds are odds: of all tests, a hundredth has p under .01. Tests of one draw share
    # their paths and draws share batches, which spreads that share by .006.
    p = [np.concatenate([r.p for r in compare(scene, *d)]) for d in draws(batches, 30, 1)]
    assert 0.001 < (np.concatenate(p) < 0.01).mean() < 0.03


@pytest.mark.parametrize("number", [1, 2], ids=["rough", "smooth"])
@pytest.mark.parametrize("factor", [0.98, 1.02])
def test_an_object_that_is_off_by_two_percent_is_found(scene, batches, number, factor):
    for old, new in draws(batches, 10):
        check = judged(scene, [scaled(f, f.ids == number, factor) for f in old], new)
        assert not check.agrees
        assert scene.objects[number - 1].name in check.where
        assert np.sign(check.relative) == np.sign(1 - factor)


def test_a_bias_of_the_size_that_would_be_seen_is_seen(scene, batches):
    found = 0
    for old, new in draws(batches, 20):
        visible = judged(scene, old, new).visible
        assert 0.001 < visible < 0.1
        new = [scaled(f, f.ids > 0, 1 + visible) for f in new]
        found += not judged(scene, old, new).agrees
    assert found >= 19


def test_a_block_that_is_off_is_found_where_it_is(scene, batches):
    ids = np.zeros((32, 64), bool)
    ids[8:24, 8:24] = True  # parts of four blocks
    old, new = next(draws(batches, 1))
    ids &= old[0].ids == 1
    check = judged(scene, [scaled(f, ids, 1.3) for f in old], new)
    assert not check.agrees and "rough" in check.where


def test_light_in_a_layer_that_the_other_has_not_is_a_difference(scene, batches):
    old, new = next(draws(batches, 1))
    dark = [replace(f, layers={n: p for n, p in f.layers.items() if n != "direct"}) for f in old]
    assert judged(scene, dark, new).where.startswith("direct,")


def test_pixels_without_noise_may_differ_by_rounding_alone(scene, batches):
    still = [batches[0]] * 8
    assert judged(scene, still, [scaled(f, f.ids > 0, 1 + 1e-7) for f in still]).agrees
    assert not judged(scene, still, [scaled(f, f.ids > 0, 1.001) for f in still]).agrees


def test_verify_holds_the_store_against_fresh_batches(scene, tmp_path):
    sound, off = Store(tmp_path / "sound"), Store(tmp_path / "off")
    for number in range(8):
        task = Task(scene, "model", FEW, number)
        frame, traced = trace_batch(task, task.identity)
        sound.save(*task, frame, traced)
        off.save(*task, scaled(frame, frame.ids == 2, 1.02), traced)
    (check,) = verify([(scene, "model", FEW), (scene, "physical", FEW)], sound)
    assert check.agrees and (check.old, check.new) == (8, 8)
    assert FAMILY_ERROR == 1e-3
    (check,) = verify([(scene, "model", FEW)], off, batches=4)
    assert not check.agrees and (check.old, check.new) == (8, 4)
    assert verify([(scene, "physical", FEW)], sound) == []  # it is not stored
    assert len(sound.load(scene, "model", FEW)) == 8 < FRESH


def other_ids(frame, traced, count=3):
    ids = frame.ids.copy()
    y, x = np.nonzero(ids == 1)
    ids[y[:count], x[:count]] = 2
    return replace(frame, ids=ids), traced


def other_background(frame, traced, factor=1.0001):
    rgb = frame.rgb.copy()
    rgb[0, 0] *= factor
    return replace(frame, rgb=rgb), traced


def traced_elsewhere(frame, traced):
    traced = traced.copy()
    traced[0, :3] = True
    return frame, traced


def rounded_otherwise(frame, traced):
    return other_background(*other_ids(frame, traced, 2), 1 + 1e-6)


@pytest.mark.parametrize(
    ("change", "named"),
    [
        (other_ids, "ids in 3 pixels"),
        (other_background, "background in 1 pixel"),
        (traced_elsewhere, "traced pixels in 3 pixels"),
        (rounded_otherwise, ""),
    ],
)
def test_what_has_no_noise_may_differ_by_rounding_alone(scene, tmp_path, change, named):
    store = Store(tmp_path / "store")
    for number in range(8):
        task = Task(scene, "model", FEW, number)
        frame, traced = trace_batch(task, task.identity)
        assert not traced[0, 0]
        store.save(*task, *change(frame, traced))
    (check,) = verify([(scene, "model", FEW)], store, batches=2)
    assert check.agrees == (not named)
    assert not named or (check.where == named and np.isnan(check.sigma))
