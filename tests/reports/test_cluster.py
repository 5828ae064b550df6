"""A run whose references a cluster traces."""

import pytest

from reports.results import load_results

# What the clock decides.
TIMES = {"frame_ms", "precomputation_ms", "reference_seconds"}


@pytest.mark.long
def test_a_gate_on_a_cluster_gives_the_rows_of_one_in_this_process(
    shadeproof, scheduler, hire, tmp_path
):
    workers, rows = hire(2), {}
    for name, options in (("far", ["--cluster", scheduler]), ("near", [])):
        words = ["gate", "--suite", "tiny", "--out", tmp_path / name, *options]
        code, _, err = shadeproof(*words, "--store", tmp_path / f"store of {name}")
        assert code == 0, err
        results = load_results(tmp_path / name / "results.json")
        rows[name] = [r.model_dump_json(exclude=TIMES) for r in results.rows]
        assert results.missing == []
        if name == "far":
            assert all(w.poll() is None for w in workers)
            assert "batch 0 is stored" in err
    assert len(rows["far"]) == 3 * 2 * 4
    assert rows["far"] == rows["near"]


@pytest.mark.parametrize("command", ["gate", "compare", "references"])
def test_a_dead_scheduler_is_one_line_and_exit_code_2(shadeproof, monkeypatch, command):
    monkeypatch.setattr("reference.executor.PATIENCE", 0.5)
    code, _, err = shadeproof(command, "--suite", "tiny", "--cluster", "tcp://127.0.0.1:1")
    assert code == 2
    (line,) = err.splitlines()
    assert line.startswith("error: --cluster: tcp://127.0.0.1:1: no Dask scheduler answers; ")
