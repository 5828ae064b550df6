"""The command `attack`: what it writes, what it lists, and what it says of a slip."""

import pytest

from tests.reports.attacks import full_attack, mutant


@pytest.fixture
def judged(monkeypatch, tmp_path):
    """Every change is caught, without a gate; in a folder of its own."""

    def attack(changes, suite, store, jobs, told):
        found = [mutant(c.id, by="rows; tables") for c in changes]
        for m in found:
            told(m)
        return found

    monkeypatch.setattr("reports.run.attack.attack", attack)
    monkeypatch.setattr("reports.run.attack.shipped", lambda suite, store: store)
    monkeypatch.chdir(tmp_path)
    return tmp_path


WHOLE = full_attack().model_dump_json()


def test_a_part_of_an_attack_leaves_a_whole_one_alone(shadeproof, judged):
    path = judged / "reports/out/attack.json"
    path.parent.mkdir(parents=True)
    path.write_text(WHOLE)
    for words in (("--only", "no masking"), ("--kind", "control")):
        code, said, err = shadeproof("attack", *words)
        assert code == 0 and "caught" in said, err
        assert path.read_text() == WHOLE and list(path.parent.iterdir()) == [path]


def test_a_part_is_written_where_one_asks_for_it(shadeproof, judged):
    code, _, err = shadeproof("attack", "--only", "no masking", "--out", judged / "part")
    assert code == 0, err
    assert {p.name for p in (judged / "part").iterdir()} == {"attack.json", "attack.html"}
    assert err.splitlines()[-1] == "[1/1] caught: no masking rows"  # the first reason, whole


def test_names_are_listed(shadeproof):
    code, said, _ = shadeproof("attack", "--list", "--kind", "realistic")
    names = said.splitlines()
    assert code == 0 and len(names) >= 40 and "no masking" in names
    assert len(shadeproof("attack", "--list")[1].splitlines()) > 800


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("--only", "no maskng"), ("--only: no maskng", "is it 'no masking'", "--list")),
        (("--only", "zzzzz"), ("no change has such a name; see",)),
        (("--only", "no masking", "--kind", "rule"), ("--kind: rule", "give --kind realistic")),
        (("--count", 0, "--kind", "rule"), ("--count: 0", "give 1 or more")),
        (("--only", "no masking", "--suite", "missing"), ("unknown name 'missing'", "guard")),
    ],
)
def test_a_slip_is_told_in_one_line(shadeproof, words, told):
    code, _, err = shadeproof("attack", *words)
    assert code == 2 and len(err.splitlines()) == 1 and len(err) < 300
    assert all(text in err for text in told)
