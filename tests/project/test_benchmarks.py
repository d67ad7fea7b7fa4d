"""The benchmarks are not run by the tests, but each can be started."""

import importlib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
NAMES = sorted(path.stem for path in (ROOT / "benchmarks").glob("bench_*.py"))


@pytest.mark.parametrize("name", NAMES)
def test_can_be_imported_and_has_rows(name, monkeypatch):
    """A name that is no longer there, which only `make bench` would meet."""
    monkeypatch.syspath_prepend(str(ROOT))
    assert callable(importlib.import_module(f"benchmarks.{name}").rows)
