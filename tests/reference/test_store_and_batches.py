"""The store of references, and how they grow."""

import ast
import json
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
import trimesh

from reference import batches
from reference import store as store_module
from reference.batches import PathTracer, batch_seed, grow, render_batch
from reference.maker import HERE, SOURCES, _bare, code_digest, maker
from reference.store import Store, contents, key
from scenes import frame as frames
from scenes.frame import Frame
from scenes.schema import Object
from scenes.suite import Sampling
from tests.reference.cases import metal, plastic

FEW = Sampling(samples_per_batch=4, max_samples=80)
NOISY_SKY = np.random.default_rng(8).uniform(0, 2, (32, 64, 3))


@pytest.fixture
def store(tmp_path):
    return Store(tmp_path / "references")


def same(a, b):
    equal = np.array_equal(a.rgb, b.rgb) and np.array_equal(a.ids, b.ids)
    equal &= list(a.layers) == list(b.layers)
    return equal and all(np.array_equal(a.layers[name], b.layers[name]) for name in a.layers)


def test_a_frame_says_how_it_was_made(make_case):
    frame = PathTracer("unoccluded", samples=5, seed=9).render(make_case())
    assert frame.rgb.shape == (36, 48, 3)
    assert frame.rgb.dtype == np.float32
    assert frame.ids.max() == 1
    assert frame.seconds > 0
    told = json.loads(json.dumps(frame.provenance))
    assert told["samples"] == 6  # 2 x 3, the next that can be stratified
    assert told["seed"] == 9
    assert {"mitsuba", "drjit", "variant", "device", "truth"} <= set(told)


def test_at_least_eight_batches_then_more_until_enough_and_never_beyond_the_limit(make_case, store):
    case, asked = make_case(NOISY_SKY), []

    def enough(found):
        asked.append(len(found))
        return len(found) >= 12

    told = []
    found = grow(case, "model", FEW, enough, store, lambda *done: told.append(done))
    assert asked == [8, 16]
    assert len(found) == 16
    assert told[0] == (1, 8)
    assert told[-1] == (16, 16)
    assert [f.provenance["batch"] for f in found] == list(range(16))
    assert len(grow(case, "model", FEW, lambda _: False, store)) == 20


def test_growing_keeps_what_is_there_and_mends_what_is_not(make_case, store):
    case = make_case(NOISY_SKY)
    first = grow(case, "model", FEW, lambda _: True, store)
    folder = store.path(key(case, "model", FEW))
    times = {p: p.stat().st_mtime_ns for p in folder.glob("batch-*")}
    assert len(times) == 16
    (folder / "batch-003.json").unlink()  # as if killed before its end
    (folder / "batch-005.exr").write_bytes(b"torn")
    assert len(store.load(case, "model", FEW)) == 6
    again = grow(case, "model", FEW, lambda _: True, store)
    assert all(same(a, b) for a, b in zip(first, again, strict=True))
    kept = {p for p, t in times.items() if p.exists() and p.stat().st_mtime_ns == t}
    assert len(kept) >= 12


def test_a_stored_batch_is_the_batch_that_was_rendered(make_case, store):
    case = make_case(NOISY_SKY)
    grow(case, "model", FEW, lambda _: True, store)
    seed = batch_seed(key(case, "model", FEW), 2)
    assert same(store.load(case, "model", FEW)[2], render_batch(case, "model", 4, seed))


def test_a_killed_save_leaves_nothing_that_loads(make_case, store, monkeypatch):
    case = make_case()
    frame = Frame(np.ones((36, 48, 3), np.float32), np.zeros((36, 48), np.uint8), 1.0, {})
    traced = np.zeros((36, 48), bool)
    store.save(case, "model", FEW, 0, frame, traced)
    true_replace = frames.os.replace

    def killed(source, target):
        if str(target).endswith("batch-001.json"):
            raise KeyboardInterrupt
        true_replace(source, target)

    monkeypatch.setattr(frames.os, "replace", killed)
    with pytest.raises(KeyboardInterrupt):
        store.save(case, "model", FEW, 1, frame, traced)
    assert [f.provenance["batch"] for f in store.load(case, "model", FEW)] == [0]


def test_the_key_holds_what_makes_the_picture_and_nothing_else(make_case):
    def key_of(case, kind="model", sampling=FEW):
        return key(case, kind, sampling)

    def with_material(material):
        return case.model_copy(
            update={"objects": (ball.model_copy(update={"material": material}),)}
        )

    case = make_case(material=metal(f0="Cu"))
    ball = case.objects[0]
    same_picture = [
        case.model_copy(update={"id": "other", "scene": "other"}),
        case.model_copy(
            update={"objects": (ball.model_copy(update={"name": "b", "judged": False}),)}
        ),
        with_material(metal(f0="Cu", name="x", description="y", source="z")),
        with_material(metal(f0="Cu", weight=1, weight_g=1)),
    ]
    assert {key_of(c) for c in same_picture} == {key_of(case)}
    assert key_of(case, sampling=Sampling(samples_per_batch=4, max_samples=999)) == key_of(case)
    other_picture = [
        with_material(metal(f0="Ag")),
        with_material(metal(f0="Cu", roughness=0.51)),
        with_material(metal(f0="Cu", weight=0.9)),
        with_material(metal(f0="Cu", weight_g=0.9)),
        case.model_copy(update={"width": 47}),
        case.model_copy(
            update={"environment": case.environment.model_copy(update={"rotation": 1})}
        ),
        case.model_copy(update={"objects": (ball.model_copy(update={"position": (0, 0, 0.1)}),)}),
        case.model_copy(
            update={"objects": (*case.objects, Object(**(dict(ball) | {"name": "c"})))}
        ),
        make_case(sky=0.5, material=metal(f0="Cu")),
    ]
    keys = [key_of(c) for c in (case, *other_picture)]
    keys += [key_of(case, "physical")]
    keys += [key_of(case, sampling=Sampling(samples_per_batch=9, max_samples=999))]
    assert len(set(keys)) == len(keys)


@pytest.fixture
def room(tmp_path):
    """A copy of the sources, to be changed; `maker(room)` reads it."""
    for name in SOURCES:
        copy = tmp_path / "room" / name
        copy.parent.mkdir(parents=True, exist_ok=True)
        copy.write_text((HERE / name).read_text())
    return tmp_path / "room"


def test_a_change_of_the_code_is_another_maker(room):
    assert maker(room) == maker()
    path = room / "mixture.py"
    path.write_text(path.read_text() + "CHANGED = 1\n")
    maker.cache_clear()
    assert maker(room)["code"] != maker()["code"]


def test_comments_docstrings_and_layout_are_no_part_of_the_code():
    plain = code_digest("def f(x):\n    return [x,\n            1.0]\n")
    same = '"""Of a module."""\n\n\ndef f(x):  # why\n    """Of a function."""\n    return [x, 1.0]'
    assert code_digest(same) == plain
    for other in ("[x, 1]", "[x, 1.5]", "[1.0, x]", "(x, 1.0)", "[x, 1.0, ]or f", "'[x, 1.0]'"):
        assert code_digest(f"def f(x):\n    return {other}\n") != plain
    assert code_digest("def f(x):\n    pass\n    return [x, 1.0]\n") != plain


def test_the_digest_of_the_code_is_the_same_in_every_version_of_python():
    code = (
        "class A(B):\n    x: int = 1\n\n    def f(self, *a, **k):\n        return f'{a!r:>{1}} b'\n"
    )
    assert code_digest(code).startswith("0a7f5396")


def test_an_empty_string_at_the_end_of_a_format_is_nothing():
    """Python 3.12 puts one there."""
    plain, ended = (ast.parse("x = f'{a:>{1}}'") for _ in range(2))
    ended.body[0].value.values[0].format_spec.values.append(ast.Constant(""))
    assert ast.dump(plain) != ast.dump(ended) and _bare(plain) == _bare(ended)


MADE_OTHERWISE = {
    "normals": ("load_mesh", "normals"),
    "vertices": ("load_mesh", "vertices"),
    "faces": ("load_mesh", "faces"),
    "texels": ("load_environment", "radiance"),
}


@pytest.mark.parametrize(("loader", "array"), MADE_OTHERWISE.values(), ids=MADE_OTHERWISE)
@pytest.mark.parametrize("mesh", ["sphere", "a file"])
def test_arrays_that_a_library_makes_otherwise_are_other_inputs(
    make_case, monkeypatch, tmp_path, loader, array, mesh
):
    if mesh == "a file":
        mesh = str(tmp_path / "cone.ply")
        trimesh.creation.cone(1, 2).export(mesh)
    case = make_case(objects=(Object(name="a", mesh=mesh, material=metal()),))
    true_load, before = getattr(store_module, loader), contents(case, "model", FEW)

    def otherwise(path):
        made = true_load(path)
        changed = getattr(made, array).copy()
        changed.flat[0] = changed.flat[0] + 1
        return replace(made, **{array: changed})

    def forget():
        store_module._mesh_digest.cache_clear()
        store_module._environment_digest.cache_clear()

    forget()
    assert contents(case, "model", FEW) == before
    forget()
    monkeypatch.setattr(store_module, loader, otherwise)
    assert contents(case, "model", FEW) != before
    forget()


def test_arrays_are_digested_with_shape_and_type_whatever_their_layout():
    array = np.arange(6, dtype=np.float32).reshape(2, 3)
    plain = store_module._arrays_digest(array)
    for same in (np.asfortranarray(array), array.astype(">f4"), np.repeat(array, 2, 1)[:, ::2]):
        assert store_module._arrays_digest(same) == plain
    for other in (array.reshape(3, 2), array.astype(np.float64), array.view(np.uint32)):
        assert store_module._arrays_digest(other) != plain


def test_another_version_of_the_path_tracer_is_another_maker(make_case, monkeypatch):
    case, before = make_case(), key(make_case(), "model", FEW)
    monkeypatch.setattr(store_module, "maker", lambda: maker() | {"mitsuba": "9.9.9"})
    assert key(case, "model", FEW) != before
    assert contents(case, "model", FEW)["objects"]


def test_untraced_pixels_cost_little_room(make_case, store):
    # Noise in every pixel, of which a small ball covers few.
    case = make_case(
        NOISY_SKY, objects=(Object(name="b", mesh="sphere", scale=0.2, material=metal()),)
    )
    grow(case, "model", FEW, lambda _: True, store)
    folder = store.path(key(case, "model", FEW))
    sizes = [p.stat().st_size for p in folder.glob("batch-*.exr")]
    assert max(sizes) < 0.3 * (folder / "background.exr").stat().st_size
    (record,) = store.records()
    assert (record.case, record.kind, record.state) == ("test", "model", "current")
    assert (record.batches, record.samples) == (8, 32)
    assert record.size == sum(p.stat().st_size for p in folder.iterdir())


def test_two_processes_that_save_the_same_batches_do_no_harm(make_case, store, tmp_path):
    case = make_case(NOISY_SKY)
    (tmp_path / "case.json").write_text(case.model_dump_json())
    script = f"""
import sys, numpy as np
from pathlib import Path
from reference.store import Store
from scenes.frame import Frame
from scenes.schema import Case
from scenes.suite import Sampling
case = Case.model_validate_json(Path({str(tmp_path / "case.json")!r}).read_text())
rgb = np.random.default_rng(0).random((36, 48, 3), np.float32)
frame = Frame(rgb, np.ones((36, 48), np.uint8), 1.0, {{}})
for number in list(range(8)) * 5:
    Store({str(store.folder)!r}).save(case, "model", Sampling(samples_per_batch=4, max_samples=80),
                                      number, frame, np.ones((36, 48), bool))
assert "mitsuba" not in sys.modules
"""
    started = [subprocess.Popen([sys.executable, "-c", script]) for _ in range(2)]
    assert [p.wait() for p in started] == [0, 0]
    loaded = store.load(case, "model", FEW)
    assert len(loaded) == 8
    rgb = np.random.default_rng(0).random((36, 48, 3), np.float32)
    assert all(np.array_equal(f.rgb, rgb) for f in loaded)
    assert not list(store.folder.rglob(".*"))


def test_batches_scatter_as_their_own_spread_says(make_case):
    # Two sets of 8: the difference of their means over its standard error is Student's t, 14 dof.
    case = make_case(NOISY_SKY, material=plastic(), width=64, height=64)
    runs = [render_batch(case, "model", 16, batch_seed("x", k)) for k in range(16)]
    rgb = np.stack([r.rgb[r.ids > 0] for r in runs]).astype(float)
    a, b = rgb[:8], rgb[8:]
    t = (a.mean(0) - b.mean(0)) / np.sqrt((a.var(0, ddof=1) + b.var(0, ddof=1)) / 8)
    assert t.size > 2000
    assert t.std() == pytest.approx(np.sqrt(14 / 12), rel=0.06)
    assert abs(t.mean()) < 0.1
    # And over the object: pixels are independent, so variances of pixels add up.
    totals, pixels = rgb.mean(axis=(1, 2)), rgb.var(axis=0, ddof=1).mean(axis=1).mean()
    ratio = totals.var(ddof=1) / (pixels / rgb.shape[1])
    assert 0.3 < ratio < 2.6  # chi-squared over 15, at its .1 % ends: .23 to 2.51


def test_seeds_differ_between_batches_and_references():
    seeds = {batch_seed(identity, k) for identity in ("a", "b") for k in range(1000)}
    assert len(seeds) == 2000
    assert max(seeds) < 2**32
    assert batches.batch_seed("a", 1) == batch_seed("a", 1)
