"""The command `limits`: what it leaves, prints and ends with."""

import pytest

from reports.limits.results import load_limits
from tests.reports.attacks import full_limits
from tests.reports.small import small_suite


@pytest.fixture
def ended(shadeproof, tmp_path, monkeypatch):
    """Run the command where a measurement found something; its exit code and what it printed."""
    (tmp_path / "s.toml").write_text(small_suite(size=(32, 24), budget="energy_error = 0.1"))

    def end(found):
        monkeypatch.setattr("reports.run.limits.limits", lambda *_: found)
        folders = ("--out", tmp_path, "--store", tmp_path / "store")
        code, out, _ = shadeproof("limits", "--suite", tmp_path / "s.toml", *folders)
        assert load_limits(tmp_path / "limits.json") == found
        assert (tmp_path / "attack.html").is_file()
        return code, out

    return end


def test_limits_are_printed_with_their_units_and_what_bounds_them(ended):
    _, out = ended(full_limits())
    assert "caught 95 times in 100 by the whole suite" in out
    for found in full_limits().limits:
        assert f"{found.parameter} {found.sign}" in out


def test_it_ends_with_1_only_where_what_is_right_was_failed(ended):
    quiet, alarmed = (
        full_limits(false_alarms=[told.model_copy(update={"alarms": alarms})])
        for told in full_limits().false_alarms[:1]
        for alarms in (0, 2)
    )
    assert ended(quiet)[0] == 0
    code, out = ended(alarmed)
    assert code == 1 and "2 false alarms" in out
