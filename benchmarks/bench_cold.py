"""What a newcomer waits for: compiling with an empty cache, and the same calls once it is filled.

`python -m benchmarks.compiling` lists the kernels behind the first figure.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from typing import Any

from . import bench_import
from .measure import ROOT, Row

GOALS = {"all kernels": "<= 45 s", "chapter 01": "<= 20 s"}
CALLS = {"all kernels": [], "chapter 01": ["--chapter", "01"]}


def rows() -> Iterator[Row]:
    for name, options in CALLS.items():
        with tempfile.TemporaryDirectory() as cache:
            cold, warm = (fresh(*options, "--cache", cache) for _ in range(2))
        figure = f"{cold['seconds']:.1f} CPU s for {cold['count']} signatures"
        yield Row(f"{name}: compiled with an empty cache", figure, GOALS[name])
        figure = f"{warm['longest']:.2f} s, {warm['count']} signatures compiled"
        yield Row(f"{name}: longest call once the cache is filled", figure, "< 3 s, 0 compiled")
    yield from bench_import.rows()


def fresh(*options: str) -> dict[str, Any]:
    """What `benchmarks.compiling` measures in an interpreter of its own."""
    command = [sys.executable, "-m", "benchmarks.compiling", "--json", *options]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    return json.loads(done.stdout)  # type: ignore[no-any-return]
