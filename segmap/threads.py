"""Work on several cores, and objects for several threads: compiled loops let other threads run.

All cores are used, or as many as the environment variable `SEGMAP_THREADS` says. What is itself
one worker of several has one: a process of a pool, and every thread but the main one.

Fork a process while no other thread works, or start processes anew (`spawn`).
"""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from copy import deepcopy
from functools import cached_property, wraps
from typing import Any, Concatenate, ParamSpec, Self, TypeVar

import numpy as np
from numpy.typing import NDArray

from .progress import announce

Thing = TypeVar("Thing")
Found = TypeVar("Found")
P = ParamSpec("P")
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
    count = os.environ.get(THREADS, str(cores()))
    if not count.isdecimal() or int(count) < 1:
        raise ValueError(f"{THREADS} must be a whole number of at least 1, got {count!r}")
    return int(count)


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
        outcomes: list[Any] = []
        for one in (pool.map if pool and len(things) > 1 else map)(work, things):
            outcomes.append(one)
            if words:
                announce(len(outcomes) / len(things), words)
        return outcomes

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


class computed(cached_property[Found]):
    """A property that is computed once for each object; two threads may both compute it.

    Before Python 3.12 that of `functools` has one lock for all objects: threads wait for each other
    while a loop runs.
    """

    def __init__(self, func: Callable[[Any], Found]) -> None:
        super().__init__(func)
        self.lock: AbstractContextManager[Any] = nullcontext()


class Locked:
    """An object whose arrays loops change in place: one thread at a time may be in it.

    Who needs several of its methods to see the same state holds `lock` meanwhile. Of two objects
    the one that holds the other is locked first. A copy, also by pickle or `copy.copy`, is of one
    moment, shares nothing with it and has its own lock.
    """

    lock: AbstractContextManager[Any]

    def __new__(cls, *args: Any, **options: Any) -> Self:
        """A new one, or a copy to be filled, with a lock of its own."""
        instance = super().__new__(cls)
        instance.lock = threading.RLock()
        return instance

    def __getstate__(self) -> dict[str, Any]:
        with self.lock:
            state = {name: value for name, value in vars(self).items() if name != "lock"}
            return deepcopy(state, {id(self): self})  # what leads back to it still does

    def __copy__(self) -> Self:
        return deepcopy(self)

    def become(self, other: Self) -> None:
        """Take over what another one holds, which nobody uses any more."""
        with self.lock:
            for name in vars(other).keys() - {"lock"}:
                setattr(self, name, getattr(other, name))


Own = TypeVar("Own", bound=Locked)


def locked(method: Callable[Concatenate[Own, P], Found]) -> Callable[Concatenate[Own, P], Found]:
    """A method that waits until no other thread is in the object."""

    @wraps(method)
    def alone(self: Own, /, *args: P.args, **options: P.kwargs) -> Found:
        with self.lock:
            return method(self, *args, **options)

    return alone
