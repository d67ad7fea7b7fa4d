"""The same work on many things, on all cores: compiled loops let other threads run."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from typing import TypeVar

Thing = TypeVar("Thing")
Found = TypeVar("Found")


def cores() -> int:
    """Cores that this process may use."""
    affinity = getattr(os, "sched_getaffinity", None)  # Linux
    return len(affinity(0)) if affinity else os.cpu_count() or 1


def in_threads(work: Callable[[Thing], Found], things: Sequence[Thing]) -> list[Found]:
    """What `work` finds for each thing, in their order; an interrupt waits for those begun only."""
    workers = min(cores(), len(things))
    if workers < 2:
        return [work(thing) for thing in things]
    from concurrent.futures import ThreadPoolExecutor

    with ThreadPoolExecutor(workers) as pool:
        return list(pool.map(work, things))
