"""Spoilt input ends in one clear line or is valid still: no traceback, no hang, no crash."""

import os
import secrets

import pytest

from tests.fuzz.campaign import campaign
from tests.fuzz.inputs import SHARES
from tests.fuzz.supervisor import Supervisor, unclear

# Of the short test; a number of their own, drawn anew, have the long one's inputs.
SEED, FEW, MANY = 5, 200, 10_000


@pytest.fixture(scope="module")
def supervisor():
    with Supervisor(seconds=3, growth=80 << 20, danger=200 << 20, mode=("bare",)) as made:
        yield made


def checked(tally, seed, keep):
    told = [
        f"#{given.number} {given.kind} ({given.how}): {' | '.join(ended.problems)}\n"
        f"   again: python -m tests.fuzz --seed {seed} --from {given.number}; kept: {keep}"
        for given, ended in tally.wrong
    ]
    assert not told, "\n".join([f"{len(told)} inputs ended wrong, seed {seed}", *told[:20]])
    kinds = {kind for kind, _ in tally.counts}
    assert kinds == set(SHARES), "a kind of input never came"
    drawn = sum(n for (_, end), n in tally.counts.items() if end == "drawn")
    refused = sum(n for (_, end), n in tally.counts.items() if end == "refused")
    assert drawn and refused, "nothing was drawn, or nothing refused: the fuzzer fuzzes nothing"


def test_spoilt_input_is_refused_in_one_line_or_is_valid_still(tmp_path):
    checked(campaign(SEED, range(FEW), tmp_path), SEED, tmp_path)


@pytest.mark.long
def test_ten_thousand_spoilt_inputs_too(tmp_path):
    seed = int(os.environ.get("FUZZ_SEED", secrets.randbelow(2**31)))
    checked(campaign(seed, range(MANY), tmp_path), seed, tmp_path)


@pytest.mark.parametrize(
    ("name", "problem"),
    [
        ("raises", "KeyError: 'planted'"),
        ("hangs", "hangs"),
        ("crashes", "crashes with -11"),
        ("hungers", "takes 10"),
        ("devours", "takes more than 200 MiB"),
        ("leaves-half", "refuses, but leaves results.json"),
        ("mumbles", "refuses in 2 lines"),
        ("deletes", "takes away scene.toml"),
    ],
)
def test_what_must_not_be_is_seen(supervisor, tmp_path, name, problem):
    (tmp_path / "results.json").write_text("of an earlier run")
    (tmp_path / "scene.toml").write_text("a user's own")
    ended = supervisor.run([f"!{name}", str(tmp_path)], (tmp_path,))
    assert any(problem in told for told in ended.problems), ended
    assert not supervisor.run(["--version"]).problems  # and the next input is run as ever


@pytest.mark.parametrize(
    ("line", "problem"),
    [
        ("error: a.toml: field: is wrong; mend it", ""),
        ("error: a.toml: field: is wrong", "does not say"),
        ("error: None: field: is wrong; mend it", "'None'"),
        ("error: a.toml: field: <class 'int'>; mend it", "speaks of '<class'"),
        ("error: a.toml: \x1b[31mred; mend it", "not printable"),
        (f"error: a.toml: {'x' * 5000}; mend it", "characters"),
        ("", "0 lines"),
    ],
)
def test_a_line_that_no_user_could_read_is_seen(line, problem):
    assert any(problem in told for told in unclear(line)) if problem else not unclear(line)
