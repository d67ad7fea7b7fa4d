"""Long work says how far it is, and whoever listens may stop it.

`pose_graph(log, progress=listen)` calls `listen(share, words)` at each step: the share that is
done, from 0 to 1, of what the words name. What it raises ends the work. All alignments, reductions,
`build_map`, `deskew` and `read` take `progress=`; `told` does the same for all that is called
within it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

#: Is called with the share that is done and what is done; what it raises ends the work.
Progress = Callable[[float, str], object]
Thing = TypeVar("Thing")

#: The time left is estimated after this many seconds of one kind of work.
FIRST_ESTIMATE_S = 2.0
#: The time left is estimated after this share of the work: the first steps alone do not tell it.
FIRST_ESTIMATE_SHARE = 0.05

_listener: ContextVar[Progress | None] = ContextVar("listener", default=None)


class Stopped(Exception):
    """The work was stopped before it was done."""


class Compiling(str):
    """Words on loops that are compiled: the share that is done says nothing of the time left."""


@contextmanager
def told(progress: Progress) -> Iterator[None]:
    """Tell a listener how far all work is that is called within.

    Examples
    --------
    >>> from segmap import load
    >>> from segmap.alignment import pose_graph
    >>> def listen(share, words):
    ...     print(f"{share:4.0%} {words}")
    >>> with told(listen):
    ...     alignment = pose_graph(load("room")[:2])
      0% placing scan 1 of 2
     50% placing scan 2 of 2
      0% solving for all poses
    100% laying each scan once more
    """
    if not callable(progress):
        raise ValueError(f"progress must be a function of a share and words, got {progress!r}")
    token = _listener.set(progress)
    try:
        yield
    finally:
        _listener.reset(token)


@contextmanager
def compiling_only(state: Callable[[], tuple[float, str]]) -> Iterator[None]:
    """Of all work called within only compiling is told, by another share and other words."""
    if (listen := _listener.get()) is None:
        yield
        return

    def hand_on(share: float, said: str) -> None:
        """How far the whole is instead of the part."""
        if isinstance(said, Compiling):
            listen(*state())

    with told(hand_on):
        yield


def announce(share: float, words: str) -> bool:
    """Say how far the work is, to whoever listens in this thread; answers whether somebody does."""
    if (listen := _listener.get()) is None:
        return False
    listen(share, words)
    return True


def time_left(taken: float, share: float) -> str:
    """What follows from the seconds that a share took, in words; nothing where that is too early.

    Examples
    --------
    >>> time_left(3.0, 0.04), time_left(3.0, 0.1), time_left(300.0, 0.5)
    ('', '27 s left', '5 min left')
    """
    if taken < FIRST_ESTIMATE_S or share < FIRST_ESTIMATE_SHARE:
        return ""
    seconds = taken * (1 - share) / share
    return f"{seconds:.0f} s left" if seconds < 100 else f"{seconds / 60:.0f} min left"


def each(things: Sequence[Thing], words: str) -> Iterator[Thing]:
    """The things one after the other; before each is announced which one of how many it is."""
    for k, thing in enumerate(things):
        announce(k / len(things), f"{words} {k + 1} of {len(things)}")
        yield thing


def parts(things: NDArray[np.int64], words: str, *, size: int = 256) -> Iterator[NDArray[np.int64]]:
    """Some of the things after others, for one call of a compiled loop each; announced as well."""
    for k in range(0, len(things), size):
        announce(k / len(things), f"{words} {k + 1} of {len(things)}")
        yield things[k : k + size]
    announce(1.0, f"{words} {len(things)} of {len(things)}")
