"""How the benchmarks measure, and where they find what they measure on.

Speeds drift by a factor of two within minutes, and others may use the machine: CPU seconds are
counted, the least of several, a method right after its yardstick, and the ratio is what counts.
"""

import importlib.util
import os
import sys
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple
from unittest import mock

from segmap.threads import THREADS, cores

ROOT = Path(__file__).resolve().parents[1]
SHARED = ROOT.parent / "shared"
#: Chapters and tests read the records that git tracks: these are written only where one asks.
RECORDING = "--record" in sys.argv
RECORDS = ROOT / "data" / "records" if RECORDING else ROOT / "build" / "records"


class Row(NamedTuple):
    """One line of the table: what was measured, the figure, and what it has to reach."""

    what: str
    figure: str
    target: str = ""


def seconds(call: Callable[[], Any], repeat: int = 5) -> float:
    """Least CPU time of a call, after one that is not counted."""
    call()
    return min(once(call) for _ in range(repeat))


def once(call: Callable[[], Any], clock: Callable[[], float] = time.process_time) -> float:
    """CPU time of one call, of all its threads; or its time by another clock."""
    start = clock()
    call()
    return clock() - start


def in_turn(
    *calls: Callable[[], Any], repeat: int = 5, clock: Callable[[], float] = time.process_time
) -> list[float]:
    """Least times of several calls that take turns, so that a slow minute slows them all."""
    took = [[once(call, clock) for call in calls] for _ in range(repeat)]
    return [min(each) for each in zip(*took, strict=True)]


def on_cores(call: Callable[[], Any], repeat: int = 7) -> str:
    """Milliseconds, on the wall, of a call with one thread and with one a core; their ratio."""

    def limited(count: int) -> None:
        with mock.patch.dict(os.environ, {THREADS: str(count)}):
            call()

    calls, clock = (partial(limited, 1), partial(limited, cores())), time.perf_counter
    one, several = in_turn(*calls, repeat=repeat, clock=clock)
    return f"{1e3 * one:.1f} / {1e3 * several:.1f} ms = {one / several:.2f}"


def load(path: Path) -> Any:
    """A module by its file: the workloads beside the project."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    if spec is None or spec.loader is None or not path.exists():
        return None
    module = importlib.util.module_from_spec(spec)
    sys.modules[path.stem] = module
    spec.loader.exec_module(module)
    return module


def workloads() -> Any:
    """The fixed workloads, or None where the folder beside the project is absent."""
    return load(SHARED / "tools" / "workloads.py")


def missing(what: str) -> Iterator[Row]:
    """The row of something that is not there."""
    yield Row(what, "skipped", "its data lies beside the project and is absent here")
