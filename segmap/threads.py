"""The same work on many things, on all cores: compiled loops let other threads run."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from typing import TypeVar

from .progress import announce

Thing = TypeVar("Thing")
Found = TypeVar("Found")


def cores() -> int:
    """Cores that this process may use."""
    affinity = getattr(os, "sched_getaffinity", None)  # Linux
    return len(affinity(0)) if affinity else os.cpu_count() or 1


def in_threads(
    work: Callable[[Thing], Found], things: Sequence[Thing], words: str = ""
) -> list[Found]:
    """What `work` finds for each thing, in their order; an interrupt waits for those begun only.

    With `words` it says how many are done.
    """

    def counted(found: Iterator[Found]) -> list[Found]:
        kept = []
        for k, each in enumerate(found):
            kept.append(each)
            if words:
                announce((k + 1) / len(things), words)
        return kept

    workers = min(cores(), len(things))
    if workers < 2:
        return counted(map(work, things))
    from concurrent.futures import ThreadPoolExecutor

    with ThreadPoolExecutor(workers) as pool:
        try:
            return counted(pool.map(work, things))
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
