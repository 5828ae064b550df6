"""An attack that is interrupted ends its gates at once, and goes on where it stopped."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from reports.attack import gates, harness
from reports.attack.gates import OUT_OF_TIME, EndedError, Gates
from reports.attack.kept import Kept
from reports.attack.mutants import Change
from reports.attack.results import Attack
from reports.run import attack as attacking
from tests.reports.attacks import control, mutant

ROOT = Path(__file__).resolve().parents[2]
SLOW = "import os, time\nopen('started', 'w').write(str(os.getpid()))\ntime.sleep(60)\n"


@pytest.fixture
def slow(tmp_path):
    """A folder whose package `reports.cli` never ends."""
    (tmp_path / "reports/cli").mkdir(parents=True)
    (tmp_path / "reports/__init__.py").touch()
    (tmp_path / "reports/cli/__init__.py").touch()
    (tmp_path / "reports/cli/__main__.py").write_text(SLOW)
    return tmp_path


def alive(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    return True


PARENT = """
import signal, sys
from pathlib import Path
from concurrent.futures import ThreadPoolExecutor
from reports.attack import harness
from reports.attack.gates import Gates
from reports.attack.mutants import Change
folder = Path(sys.argv[1])
run = Gates.run
Gates.run = lambda self, words, path, home: run(self, words, [folder], folder)
signal.signal(signal.SIGTERM, signal.default_int_handler)
try:
    harness.attack([], "guard", folder, 1, print)
except KeyboardInterrupt:
    sys.exit(130)
"""


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_to_the_attack_alone_ends_its_gates_within_two_seconds(slow, wait_for, how):
    with subprocess.Popen([sys.executable, "-c", PARENT, str(slow)], cwd=ROOT) as parent:
        wait_for(lambda: (slow / "started").is_file() and (slow / "started").read_text())
        began = time.monotonic()
        parent.send_signal(how)
        assert parent.wait(10) == 130
    assert time.monotonic() - began < 2
    assert not alive(int((slow / "started").read_text()))


def test_a_gate_that_takes_too_long_is_ended_and_told_apart(slow, monkeypatch):
    monkeypatch.setattr(gates, "TIME_LIMIT", 1)
    code, said = Gates().run([], [slow], slow)
    assert code == OUT_OF_TIME and "1 s" in said
    assert not alive(int((slow / "started").read_text()))


def test_no_gate_starts_after_the_end(slow):
    ended = Gates()
    ended.end()
    with pytest.raises(EndedError):
        ended.run([], [slow], slow)
    assert not (slow / "started").exists()


@pytest.mark.parametrize(
    ("code", "said", "outcome"),
    [
        (2, "error: /a/brdf.glsl:3: does not compile: x; mend the shader", "stillborn"),
        (2, "error: this is a bug in shadeproof: TypeError: x", "stillborn"),
        (-signal.SIGSEGV, "", "stillborn"),
        (OUT_OF_TIME, "took more than 180 s", "timeout"),
        (130, "interrupted", None),
        (-signal.SIGKILL, "", None),
        (2, "error: memory: there is not enough of it; take smaller pictures", None),
        (2, "error: /tmp/x: cannot be used (No space left on device); check", None),
    ],
)
def test_an_outcome_is_only_what_the_change_did(code, said, outcome, tmp_path, refused):
    change = Change("x", "rule", "", "a", 1, "", "")
    if outcome:
        found, by = harness._outcome(change, code, said, tmp_path)
        assert found == outcome and by and not by.startswith("error:")
    else:
        refused(lambda: harness._outcome(change, code, said, tmp_path), "could not run", str(code))


def test_a_control_that_is_not_passed_fails_the_attack():
    about = {"created": "", "seconds": 1.0, "command": "", "suite": "", "seed": 1}
    slow = Attack(
        **about, generated=9, provenance={}, mutants=[control("a"), control("b", outcome="timeout")]
    )
    assert not slow.passed and [m.id for m in slow.alarms] == ["b"]


@pytest.fixture
def judging(monkeypatch):
    """Judge without gates; stop after so many. Returns the names that were judged."""
    names = []

    def attack(changes, suite, store, jobs, told):
        found = [mutant(c.id) for c in changes]
        for m in found:
            if len(names) == judged.most:
                raise KeyboardInterrupt
            names.append(m.id)
            told(m)
        return found

    def judged(changes, folder, about, most=99):
        judged.most = most
        kept = Kept(folder, about)
        made = {"command": "", "seed": 1, "generated": 9}
        return attacking.attack_suite("guard", folder, changes, 1, names_told.append, kept, **made)

    names_told = []
    judged.names, judged.told = names, names_told
    monkeypatch.setattr(attacking, "attack", attack)
    return judged


CHANGES = [Change(name, "rule", "", "a", 1, "", "") for name in "abc"]


def test_an_interrupted_attack_goes_on_where_it_stopped(judging, tmp_path):
    with pytest.raises(KeyboardInterrupt):
        judging(CHANGES, tmp_path, {}, most=2)
    assert judging.names == ["a", "b"]
    found = judging(CHANGES[1:], tmp_path, {})  # of another choice, what it has in common
    assert judging.names == ["a", "b", "c"]
    assert [m.id for m in found.mutants] == ["b", "c"]


def test_what_other_sources_gave_is_not_taken_over(judging, tmp_path, monkeypatch):
    judging(CHANGES, tmp_path, {})
    judging(CHANGES, tmp_path, {"device": "another"})
    assert judging.names == [*"abcabc"]
    monkeypatch.setattr("reports.attack.kept.sha256", lambda path: "changed")
    judging(CHANGES, tmp_path, {"device": "another"})
    assert judging.names == [*"abcabcabc"]


def test_half_a_line_is_judged_again(judging, tmp_path):
    judging(CHANGES, tmp_path, {})
    path = Kept(tmp_path, {}).path
    path.write_text(path.read_text()[:-40])
    judging(CHANGES, tmp_path, {})
    assert judging.names == [*"abcc"]
