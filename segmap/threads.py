"""The same work on many things, on several cores: compiled loops let other threads run.

All cores are used, or as many as the environment variable `SEGMAP_THREADS` says. What is itself
one worker of several has one: a process of a pool, and every thread but the main one.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from .progress import announce

Thing = TypeVar("Thing")
Found = TypeVar("Found")
Rows = NDArray[np.int64]
#: From work and things to what the work finds for each, in their order.
Each = Callable[..., list[Any]]

#: Set this environment variable to a whole number of threads, from 1.
THREADS = "SEGMAP_THREADS"


def cores() -> int:
    """Cores that this process may use."""
    affinity = getattr(os, "sched_getaffinity", None)  # Linux
    return len(affinity(0)) if affinity else os.cpu_count() or 1


def threads() -> int:
    """How many threads may work at once for who asks: 1 in a worker of several."""
    from multiprocessing import parent_process

    if threading.current_thread() is not threading.main_thread() or parent_process() is not None:
        return 1
    given = os.environ.get(THREADS, str(cores()))
    if not given.isdecimal() or int(given) < 1:
        raise ValueError(f"{THREADS} must be a whole number of at least 1, got {given!r}")
    return int(given)


@contextmanager
def team() -> Iterator[Each]:
    """Threads that stay for several rounds of work; without a second one there are none.

    An interrupt or an error waits for what has begun, and leaves the rest. With words they announce
    how many things are done.
    """
    from concurrent.futures import ThreadPoolExecutor

    workers = threads()
    pool = ThreadPoolExecutor(workers) if workers > 1 else None

    def each(work: Callable[[Any], Any], things: Sequence[Any], words: str = "") -> list[Any]:
        found: list[Any] = []
        for one in (pool.map if pool and len(things) > 1 else map)(work, things):
            found.append(one)
            if words:
                announce(len(found) / len(things), words)
        return found

    try:
        yield each
    finally:
        if pool:
            pool.shutdown(cancel_futures=True)


def in_threads(
    work: Callable[[Thing], Found], things: Sequence[Thing], words: str = ""
) -> list[Found]:
    """What `work` finds for each thing, in their order; with words it tells how many are done."""
    with team() as each:
        return each(work, things, words)


def shares(things: Rows, least: int) -> list[Rows]:
    """An array dealt out to as many threads as get at least so many of its rows each."""
    count = max(min(threads(), len(things) // least), 1)
    return [things[k::count] for k in range(count)]
