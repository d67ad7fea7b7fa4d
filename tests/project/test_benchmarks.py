"""The benchmarks are not run by the tests, but each can be started."""

import importlib
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
NAMES = sorted(path.stem for path in (ROOT / "benchmarks").glob("bench_*.py"))


@pytest.mark.parametrize("name", NAMES)
def test_can_be_imported_and_has_rows(name, monkeypatch):
    """A name that is no longer there, which only `make bench` would meet."""
    monkeypatch.syspath_prepend(str(ROOT))
    assert callable(importlib.import_module(f"benchmarks.{name}").rows)


def test_a_short_drive_is_driven(monkeypatch):
    """Catches a field of an edge that the longest row of the graph, run last, does not know."""
    monkeypatch.syspath_prepend(str(ROOT))
    assert (
        "4 loops solved at once" in importlib.import_module("benchmarks.bench_graph").drive(100)[0]
    )


def test_results_that_differ_are_named(monkeypatch, tmp_path, capsys):
    """Catches a last bit that counts as equal, words taken for a figure, a result that is gone."""
    monkeypatch.syspath_prepend(str(ROOT))
    compare = importlib.import_module("benchmarks.results").compare
    one = {"same": [0.1, np.nan], "near": [0.3], "far": [1.0], "words": "within 1 m", "gone": [1]}
    other = one | {"near": [0.1 + 0.2], "far": [1.001], "words": "within 2 m"}
    np.savez(tmp_path / "a.npz", **one)
    np.savez(tmp_path / "b.npz", **{name: other[name] for name in list(other)[:4]})
    assert compare(tmp_path / "a.npz", tmp_path / "b.npz") == 1
    *named, counts = capsys.readouterr().out.splitlines()
    assert [line.split(":")[0] for line in named] == ["far", "gone", "near", "words"]
    assert counts == "1 of 5 equal to the last bit, 1 within 1e-12, 3 differ"
    assert compare(tmp_path / "a.npz", tmp_path / "a.npz") == 0
