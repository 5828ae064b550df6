"""The commands `refs`, and runs that trace nothing."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from reports.results import load_results
from scenes.frame import sha256

ROOT = Path(__file__).resolve().parents[2]
PACK = ROOT / "scenes/references/frozen.refs"
# A machine without the path tracer.
BARE = "import sys; sys.modules['mitsuba'] = sys.modules['drjit'] = None;"
BARE += "from reports.cli import main; main()"


def without_mitsuba(*words):
    return subprocess.run(
        [sys.executable, "-c", BARE, *map(str, words)],
        cwd=ROOT,
        env=os.environ | {"DRJIT_LIBLLVM_PATH": "/nonexistent"},
        capture_output=True,
        text=True,
    )


@pytest.fixture(scope="module")
def blessed(tmp_path_factory):
    """A store that holds what comes with the code."""
    store = tmp_path_factory.mktemp("blessed")
    answer = without_mitsuba("refs", "unpack", PACK, "--digest", sha256(PACK), "--store", store)
    assert answer.returncode == 0, answer.stderr
    return store


def test_a_frozen_gate_needs_no_path_tracer(blessed, tmp_path):
    """If it exits with 2, the inputs have changed: docs/references.md says how to make the pack."""
    words = ["gate", "--frozen", "--suite", "frozen", "--store", blessed, "--out", tmp_path]
    answer = without_mitsuba(*words)
    assert answer.returncode == 0, answer.stderr
    results = load_results(tmp_path / "results.json")
    assert results.verdict == "pass"
    assert {r.reference_batches for r in results.rows} == {8}
    assert [p.name for p in blessed.iterdir()] == ["blessed"]


@pytest.fixture
def elsewhere(tmp_path):
    """The suite `frozen` as a user's own, for which no pack comes with the code."""
    return shutil.copy(ROOT / "scenes/suites/frozen.toml", tmp_path / "frozen.toml")


def test_a_frozen_gate_finds_the_pack_that_comes_with_the_code(tmp_path):
    words = ["gate", "--frozen", "--verdict-only", "--suite", "frozen"]
    words += ["--store", tmp_path / "store", "--out", tmp_path / "out", "--json"]
    answer = without_mitsuba(*words)
    assert answer.returncode == 0, answer.stderr
    told = [line for line in answer.stderr.splitlines() if not line.startswith("[")]
    assert told == [f"blessed in {tmp_path / 'store'}: 1 reference of {PACK}"]
    assert json.loads(answer.stdout)["verdict"] == "pass"
    again = without_mitsuba(*words)
    assert again.returncode == 0 and "blessed" not in again.stderr


def test_a_suite_of_the_same_name_elsewhere_has_no_pack(elsewhere, tmp_path):
    words = ["gate", "--frozen", "--suite", elsewhere, "--store", tmp_path / "store"]
    answer = without_mitsuba(*words, "--out", tmp_path / "out")
    assert answer.returncode == 2 and "0 of the 8" in answer.stderr
    assert not (tmp_path / "store").exists()


@pytest.mark.parametrize("command", ["gate", "references"])
def test_a_frozen_run_names_the_reference_that_is_missing(blessed, elsewhere, tmp_path, command):
    store = tmp_path / "store"
    shutil.copytree(blessed, store)
    next(store.rglob("batch-005.json")).unlink()
    out = ["--out", tmp_path / "out"] if command == "gate" else []
    answer = without_mitsuba(command, "--frozen", "--suite", elsewhere, "--store", store, *out)
    assert answer.returncode == 2
    (line,) = [line for line in answer.stderr.splitlines() if not line.startswith("[")]
    assert "contact.studio" in line and "'model'" in line and "7 of the 8" in line
    assert "shadeproof refs unpack" in line
    assert not (tmp_path / "out").exists()


def test_a_frozen_run_says_which_file_is_damaged_before_it_draws(blessed, tmp_path):
    store = tmp_path / "store"
    shutil.copytree(blessed, store)
    picture = next(store.rglob("batch-005.exr"))
    picture.write_bytes(b"damaged")
    words = ["gate", "--frozen", "--suite", "frozen", "--store", store, "--out", tmp_path / "out"]
    answer = without_mitsuba(*words)
    assert answer.returncode == 2
    (line,) = answer.stderr.splitlines()  # no picture's progress before it
    assert f"damaged: {picture}; delete it" in line
    assert not (tmp_path / "out").exists()


def test_a_pack_is_made_listed_and_known_by_its_digest(shadeproof, blessed, tmp_path):
    file = tmp_path / "again.refs"
    code, out, err = shadeproof(
        "refs", "pack", "--suite", "frozen", "--out", file, "--store", blessed
    )
    assert code == 0, err
    assert out.splitlines()[-1] == f"sha256:{sha256(file)}"
    assert sha256(file) == sha256(PACK)  # what was blessed, packed again
    code, out, _ = shadeproof("refs", "list", "--store", blessed)
    assert code == 0
    assert "contact.studio" in out and "blessed" in out and " 288 " in out
    code, _, err = shadeproof("refs", "unpack", file, "--digest", "0" * 64, "--store", tmp_path)
    assert code == 2
    assert len(err.splitlines()) == 1 and sha256(file) in err
    assert not (tmp_path / "blessed").exists()


def test_an_unpack_that_fails_leaves_nothing(shadeproof, tmp_path):
    (bad := tmp_path / "bad.refs").write_bytes(PACK.read_bytes()[:-1000])
    code, _, err = shadeproof("refs", "unpack", bad, "--store", tmp_path / "new/store")
    assert code == 2 and "no sound pack" in err
    (store := tmp_path / "store").mkdir()
    assert shadeproof("refs", "unpack", bad, "--store", store)[0] == 2
    assert sorted(tmp_path.rglob("*")) == [bad, store]


def test_a_path_that_cannot_be_written_is_told_from_a_full_disk(shadeproof, blessed, tmp_path):
    words = ["refs", "pack", "--suite", "frozen", "--store", blessed, "--out", tmp_path]
    code, _, err = shadeproof(*words)
    assert code == 2
    assert f"{tmp_path}: cannot be written (Is a directory); choose another path" in err
    (store := tmp_path / "file").write_text("")
    code, _, err = shadeproof("refs", "unpack", PACK, "--store", store)
    assert code == 2
    assert "cannot be written (Not a directory); choose another path" in err


def test_a_pack_of_what_is_not_stored_names_it(shadeproof, blessed, tmp_path):
    words = ["--suite", "tiny", "--out", tmp_path / "x.refs", "--store", blessed]
    code, _, err = shadeproof("refs", "pack", *words)
    assert code == 2
    assert "contact.studio" in err and "0 of the 8 batches" in err
    assert list(tmp_path.iterdir()) == []


def test_verify_tells_a_store_that_holds_from_one_that_does_not(shadeproof, blessed, tmp_path):
    words = ["refs", "verify", "--suite", "frozen", "--store"]
    code, out, err = shadeproof(*words, blessed, "--batches", "4")
    assert code == 0, out + err
    assert "agrees" in out and "8 + 4" in out
    store = tmp_path / "store"
    shutil.copytree(blessed, store)
    picture = next(store.rglob("batch-005.exr"))
    picture.write_bytes(picture.read_bytes()[:-1] + b"?")
    code, out, _ = shadeproof(*words, store, "--batches", "0")
    assert code == 1
    assert f"damaged {picture}; delete it and the .json beside it, and unpack its pack again" in out
    assert shadeproof(*words, store, "--batches", "1")[0] == 2


@pytest.mark.parametrize("batches", ["0", "2"])
def test_verify_names_the_first_reference_of_the_suite_that_is_missing(
    shadeproof, blessed, tmp_path, batches
):
    words = ["--batches", batches, "--store"]
    for suite, store in (("frozen", tmp_path / "none"), ("tiny", blessed)):
        code, out, err = shadeproof("refs", "verify", "--suite", suite, *words, store)
        assert code == 2 and out == ""
        (line,) = err.splitlines()
        assert "contact.studio" in line and "0 of the 8" in line and "refs unpack" in line


def test_verify_looks_at_the_references_of_its_suite_alone(shadeproof, blessed, tmp_path):
    store = tmp_path / "store"
    shutil.copytree(blessed, store)
    (other := store / "blessed" / ("0" * 64)).mkdir()
    (other / "reference.json").write_text("damaged")
    words = ["refs", "verify", "--suite", "frozen", "--batches", "0", "--store", store]
    code, out, err = shadeproof(*words)
    assert code == 0, err
    count = len(list(blessed.glob("blessed/*")))
    assert count == 1 and "sound every file of 1 reference\n" in out
