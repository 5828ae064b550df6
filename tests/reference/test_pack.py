"""References that travel: one file, whole and known by its digest."""

import hashlib
import json
import re
import zipfile

import numpy as np
import pytest

from reference import pack as module
from reference import store as store_module
from reference.batches import batch_seed, grow
from reference.maker import maker
from reference.pack import pack, unpack
from reference.store import Store, contents, digest, key
from scenes.errors import InputError
from scenes.frame import Frame, sha256
from scenes.suite import Sampling

FEW = Sampling(samples_per_batch=4, max_samples=80)


@pytest.fixture
def stored(make_case, tmp_path):
    """A case, and a store that holds eight made-up batches of it."""
    case, store = make_case(), Store(tmp_path / "references")
    fill(store, case, range(8))
    return case, store


def fill(store, case, numbers):
    traced = np.zeros((36, 48), bool)
    traced[9:27, 12:36] = True
    for number in numbers:
        rgb = np.random.default_rng(number).random((36, 48, 3), np.float32)
        rgb[~traced] = 0.5
        frame = Frame(rgb, traced.astype(np.uint8), 1.0, {"samples": 4, "seed": number})
        store.save(case, "model", FEW, number, frame, traced)


def packed(stored, path):
    case, store = stored
    return pack([(case, "model", FEW)], store, path, "tiny")


def no_tracing(monkeypatch):
    monkeypatch.setattr("reference.batches.render_batch", lambda *_: pytest.fail("traced"))


def test_what_is_unpacked_is_what_was_packed(stored, tmp_path):
    case, store = stored
    whole, manifest = packed(stored, tmp_path / "a.refs")
    assert whole == sha256(tmp_path / "a.refs")
    (told,) = manifest["references"]
    assert (told["case"], told["kind"], told["batches"], told["samples"]) == (
        "test",
        "model",
        8,
        32,
    )
    assert told["maker"] == maker()
    away = Store(tmp_path / "away")
    assert unpack(tmp_path / "a.refs", away, whole) == manifest
    ours, theirs = store.load(case, "model", FEW), away.load(case, "model", FEW)
    assert len(theirs) == 8
    for a, b in zip(ours, theirs, strict=True):
        np.testing.assert_array_equal(a.rgb, b.rgb)
        assert a.provenance == b.provenance
    (record,) = away.records()
    assert (record.state, record.batches) == ("blessed", 8)
    assert away.damaged() == []


def test_the_same_references_give_the_same_file(stored, tmp_path):
    first, _ = packed(stored, tmp_path / "a.refs")
    unpack(tmp_path / "a.refs", away := Store(tmp_path / "away"))
    assert packed((stored[0], away), tmp_path / "b.refs")[0] == first


def test_a_blessed_reference_survives_an_upgrade_and_our_own_does_not(
    stored, tmp_path, monkeypatch
):
    case, store = stored
    packed(stored, tmp_path / "a.refs")
    upgraded = maker() | {"mitsuba": "99.0"}
    monkeypatch.setattr(store_module, "maker", lambda: upgraded)
    assert store.load(case, "model", FEW) == []
    unpack(tmp_path / "a.refs", store)
    no_tracing(monkeypatch)
    assert len(grow(case, "model", FEW, lambda _: True, store)) == 8
    assert {r.state for r in store.records()} == {"blessed", "other packages"}


def test_a_blessed_reference_grows_by_batches_with_seeds_of_their_own(
    stored, tmp_path, monkeypatch
):
    case = stored[0]
    packed(stored, tmp_path / "a.refs")
    away = Store(tmp_path / "away")
    unpack(tmp_path / "a.refs", away)
    blessed = [f.rgb for f in away.load(case, "model", FEW)]
    seeds = []

    def traced(case, kind, samples, seed):
        seeds.append(seed)
        return Frame(np.ones((36, 48, 3), np.float32), np.ones((36, 48), np.uint8))

    monkeypatch.setattr("reference.batches.render_batch", traced)
    still = type("Stage", (), {"traced": np.ones((36, 48), bool)})()
    monkeypatch.setattr("reference.batches._stage", lambda *_: still)
    grown = grow(case, "model", FEW, lambda b: len(b) >= 16, away)
    assert [f.provenance["batch"] for f in grown] == list(range(16))
    assert all(np.array_equal(a.rgb, b) for a, b in zip(grown, blessed, strict=False))
    own = key(case, "model", FEW)
    assert seeds == [batch_seed(own, n) for n in range(8, 16)]
    assert len(list(away.path(own).glob("batch-*.exr"))) == 8
    assert len(away.load(case, "model", FEW)) == 16


def test_a_reference_that_is_missing_is_named_and_nothing_is_written(stored, tmp_path, refused):
    case, store = stored
    picture = store.path(key(case, "model", FEW)) / "batch-003.exr"
    picture.write_bytes(b"damaged")
    refused(lambda: packed(stored, tmp_path / "a.refs"), "test", "'model'", f"damaged: {picture}")
    for file in (picture, picture.with_suffix(".json")):  # as the remedy says
        file.unlink()
    refused(lambda: packed(stored, tmp_path / "a.refs"), "test", "'model'", "7 of the 8 batches")
    assert not list(tmp_path.glob("*a.refs"))


def rewritten(source, target, change):
    """A copy of a pack with its members changed: name -> bytes."""
    with zipfile.ZipFile(source) as file:
        members = {name: file.read(name) for name in file.namelist()}
    change(members)
    with zipfile.ZipFile(target, "w") as file:
        for name, data in members.items():
            file.writestr(name, data)
    return target


def declared(members, name, data):
    """Add a member that the manifest knows."""
    manifest = json.loads(members["manifest.json"])
    manifest["files"][name] = hashlib.sha256(data).hexdigest()
    members["manifest.json"] = json.dumps(manifest).encode()
    members[name] = data


def batch_of(members):
    return next(name for name in members if name.endswith("batch-002.exr"))


def retold(**fields):
    """A manifest of which some fields are changed."""

    def change(members):
        manifest = json.loads(members["manifest.json"]) | fields
        members["manifest.json"] = json.dumps(manifest).encode()

    return change


def without(pattern):
    """Members left out of the manifest too."""

    def change(members):
        manifest = json.loads(members["manifest.json"])
        for name in [n for n in members if re.search(pattern, n)]:
            del members[name], manifest["files"][name]
        members["manifest.json"] = json.dumps(manifest).encode()

    return change


def told_of_a_batch(**fields):
    """The provenance of batch 2 is changed, and the manifest knows."""

    def change(members):
        name = batch_of(members).replace(".exr", ".json")
        record = json.loads(members[name])
        record["provenance"] |= fields
        declared(members, name, json.dumps(record).encode())

    return change


def only(text):
    return lambda members: (members.clear(), members.__setitem__("manifest.json", text))


DAMAGE = {
    "files in a list": only(b'{"schema": 1, "files": []}'),
    "no files": only(b'{"schema": 1, "files": {}}'),
    "a manifest that is a list": only(b"[]"),
    "a field too many": retold(more=1),
    "no references": retold(references=[]),
    "no files but references": without("^[0-9a-f]"),
    "a head alone": without("batch|background"),
    "no background": without("background"),
    "half a background": without("background.json"),
    "seven batches": without("batch-002"),
    "half a batch": without("batch-002.exr"),
    "a number twice": told_of_a_batch(batch=3),
    "a seed twice": told_of_a_batch(seed=3),
    "no seed": told_of_a_batch(seed=None, batch=None),
    "a changed byte": lambda m: m.__setitem__(batch_of(m), m[batch_of(m)][:-1] + b"?"),
    "a lost member": lambda m: m.pop(batch_of(m)),
    "a member too many": lambda m: m.__setitem__("more", b""),
    "a path that climbs": lambda m: declared(m, "../../evil", b"x"),
    "an absolute path": lambda m: declared(m, "/tmp/evil", b"x"),
    "a head of other inputs": lambda m: declared(
        m,
        next(n for n in m if n.endswith("reference.json")),
        json.dumps(
            {"case": "x", "kind": "model", "maker": {}, "inputs": {"samples_per_batch": 4}}
        ).encode(),
    ),
    "no manifest": lambda m: m.pop("manifest.json"),
    "a manifest that is no JSON": lambda m: m.__setitem__("manifest.json", b"{"),
    "another schema": lambda m: m.__setitem__("manifest.json", b'{"schema": 2}'),
}


@pytest.mark.parametrize("change", DAMAGE.values(), ids=DAMAGE)
def test_a_damaged_or_forged_pack_is_refused_whole(stored, tmp_path, refused, change):
    packed(stored, tmp_path / "a.refs")
    bad = rewritten(tmp_path / "a.refs", tmp_path / "bad.refs", change)
    away = Store(tmp_path / "away")
    refused(lambda: unpack(bad, away), "bad.refs", "is no sound pack", "again")
    assert not away.folder.exists()
    assert not (tmp_path / "evil").exists()
    unpack(tmp_path / "a.refs", away)
    refused(lambda: unpack(bad, away), "is no sound pack")
    assert len(away.load(stored[0], "model", FEW)) == 8 and not away.damaged()


def test_an_unchanged_copy_of_the_members_is_taken(stored, tmp_path):
    packed(stored, tmp_path / "a.refs")
    copy = rewritten(tmp_path / "a.refs", tmp_path / "copy.refs", lambda members: None)
    assert unpack(copy, Store(tmp_path / "away"))["references"]


def test_a_file_of_another_digest_or_half_of_one_or_none_is_refused(stored, tmp_path, refused):
    path = tmp_path / "a.refs"
    whole, _ = packed(stored, path)
    away = Store(tmp_path / "away")
    refused(lambda: unpack(path, away, "0" * 64), "--digest", whole)
    assert unpack(path, away, f"sha256:{whole}")["schema"] == 1
    path.write_bytes(path.read_bytes()[:5000])
    refused(lambda: unpack(path, away), "is no sound pack")
    refused(lambda: unpack(tmp_path / "none", away), "no such file")


def test_a_pack_takes_the_place_of_an_earlier_one(stored, tmp_path):
    case, store = stored
    packed(stored, tmp_path / "a.refs")
    fill(store, case, range(8, 10))
    packed(stored, tmp_path / "b.refs")
    away = Store(tmp_path / "away")
    for name, count in (("a", 8), ("b", 10), ("a", 8)):
        unpack(tmp_path / f"{name}.refs", away)
        assert len(away.load(case, "model", FEW)) == count
        assert not list(away.folder.rglob(".*"))


def test_a_frozen_store_traces_nothing(stored, tmp_path, monkeypatch, refused):
    case, store = stored
    no_tracing(monkeypatch)
    frozen = grow(case, "model", FEW, lambda _: False, store, frozen=True)
    assert len(frozen) == 8  # `enough` would have had more
    with_seven = Store(tmp_path / "seven")
    fill(with_seven, case, range(7))
    refused(
        lambda: grow(case, "model", FEW, lambda _: True, with_seven, frozen=True),
        "test",
        "'model'",
        "7 of the 8",
        "refs unpack",
    )


def test_a_store_that_cannot_be_written_takes_no_pack(stored, tmp_path, refused):
    packed(stored, tmp_path / "a.refs")
    (tmp_path / "file").write_text("in the way")
    away = Store(tmp_path / "file" / "store")
    refused(lambda: unpack(tmp_path / "a.refs", away), "--store", "cannot be written", "choose")


def test_a_disk_that_fills_while_unpacking_leaves_nothing(stored, tmp_path, monkeypatch, refused):
    packed(stored, tmp_path / "a.refs")
    true_copy, copied = module._copy, []

    def full(file, name, target, wanted):
        if len(copied) == 5:
            raise OSError(28, "No space left on device")
        copied.append(name)
        true_copy(file, name, target, wanted)

    monkeypatch.setattr(module, "_copy", full)
    away = Store(tmp_path / "away")
    refused(lambda: unpack(tmp_path / "a.refs", away), "No space left on device", "free")
    assert not away.folder.exists()


def test_every_damaged_file_of_a_store_is_named(stored, tmp_path):
    case, store = stored
    packed(stored, tmp_path / "a.refs")
    unpack(tmp_path / "a.refs", store)
    assert store.damaged() == []
    own = store.path(key(case, "model", FEW))
    blessed = store.folder / "blessed" / digest(contents(case, "model", FEW))
    (own / "batch-002.json").unlink()  # cut off, which is no damage
    picture = own / "batch-001.exr"
    picture.write_bytes(picture.read_bytes()[:-1] + b"?")
    (own / "batch-004.exr").unlink()
    (blessed / "background.json").write_text("{}")
    head = json.loads((blessed / "reference.json").read_text())
    head["inputs"]["samples_per_batch"] = 9
    (blessed / "reference.json").write_text(json.dumps(head))
    expected = {picture, own / "batch-004.exr", blessed / "background.exr"}
    assert set(store.damaged()) == expected | {blessed / "reference.json"}


def test_a_batch_with_another_background_is_not_packed_beside_the_first(stored, tmp_path):
    case = stored[0]
    packed(stored, tmp_path / "a.refs")
    away = Store(tmp_path / "away")
    unpack(tmp_path / "a.refs", away)
    traced = np.ones((36, 48), bool)
    frame = Frame(np.ones((36, 48, 3), np.float32), traced.astype(np.uint8), 1.0, {"samples": 4})
    away.save(case, "model", FEW, 8, frame, traced)
    assert len(away.load(case, "model", FEW)) == 9
    _, manifest = packed((case, away), tmp_path / "b.refs")
    assert manifest["references"][0]["batches"] == 8


def test_a_pack_to_a_folder_that_cannot_be_written_is_refused(stored, tmp_path):
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(InputError, match="cannot be written"):
        packed(stored, tmp_path / "file" / "a.refs")
