"""The verdict on a map: whether its scans are placed, whether that is sure, what speaks against."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from .._display import counted
from ..metrics import doubled_walls
from ..segments import SegmentMap

if TYPE_CHECKING:
    from ._result import Alignment

#: With fewer of its scans placed a log has no map: three of four say nothing of the building.
LEAST = 0.25
#: A good map holds this share of the scans: the real logs of the benchmarks have 0.99 and more.
PLACED = 0.9
#: Of the scans that are placed at least so many are sure. A large building may be right in each of
#: its parts and bent as a whole, so not all of them must be.
SURE_SHARE = 0.5
#: More walls are not doubled in a good map: see `metrics.doubled_walls` for what was measured.
DOUBLED = 0.25

Grade = Literal["good", "doubtful", "not a map"]


@dataclass(frozen=True)
class Verdict:
    """A judgement of a map as one grade, as words, and as the figures behind both.

    Parameters
    ----------
    grade
        "not a map" where fewer than two scans of several are placed, fewer than a quarter, or no
        wall is there. "doubtful" where less than nine tenths of the scans are placed, less than
        half of those are sure, more than a quarter of the walls is doubled, or nothing but the
        wheels places them.
    words
        One line for a user, which begins with the grade in capitals; what makes the map doubtful
        comes first.
    placed, scans
        Scans with evidence of their own (`Alignment.used`), and all of them.
    sure
        Of those placed, the ones that are in all likelihood less than half a metre off; None where
        the method does not tell.
    worst : metres, or None
        Twice the largest standard deviation of a scan that is placed.
    doubled
        Share of the walls that the map shows twice; None where no map was looked at.

    Examples
    --------
    >>> from segmap import load
    >>> from segmap.alignment import odometry, pose_graph
    >>> log = load("corridor")[:40]
    >>> print(pose_graph(log).verdict)
    GOOD: 40 of 40 scans placed, 40 scans sure, all within 0.22 m
    >>> print(odometry(log).verdict)
    DOUBTFUL: nothing but the wheels places them; 40 of 40 scans placed
    """

    grade: Grade
    words: str
    placed: int
    scans: int
    sure: int | None = None
    worst: float | None = None
    doubled: float | None = None

    def __str__(self) -> str:
        return self.words


def judge(alignment: Alignment, map: SegmentMap | None = None) -> Verdict:
    """The verdict on an alignment; with the map that was made of it, also on its walls."""
    used, spread, scans = alignment.used, alignment.spread, len(alignment)
    placed, sure, worst, doubled = int(used.sum()), None, None, None
    if spread is not None:
        sure, worst = int(alignment.sure.sum()), float(2 * spread[used].max(initial=0.0))
    if map is not None and len(map):
        share = doubled_walls(map, alignment.poses[:, :2] if map.sensors is None else None)
        doubled = share if np.isfinite(share) else None
    told = f"{placed} of {counted(scans, 'scan')} placed"
    figures = placed, scans, sure, worst, doubled
    if placed < min(2, scans) or placed < LEAST * scans or not scans:
        return Verdict("not a map", f"NOT A MAP: {told}", *figures)
    if map is not None and not len(map):
        return Verdict("not a map", f"NOT A MAP: {told}, but no wall found", *figures)
    said = [(placed < PLACED * scans, told)]  # and whether it speaks against the map
    if alignment.method == "odometry":
        said.append((True, "nothing but the wheels places them"))
    if sure is not None:
        said.append((sure < SURE_SHARE * placed, f"{counted(sure, 'scan')} sure"))
    if worst:
        said.append((False, f"all within {worst:.2f} m"))
    if doubled is not None:
        said.append((doubled > DOUBLED, f"{100 * doubled:.0f} % of the walls doubled"))
    against, rest = ([text for bad, text in said if bad is kind] for kind in (True, False))
    words = "; ".join(", ".join(texts) for texts in (against, rest) if texts)
    if against:
        return Verdict("doubtful", f"DOUBTFUL: {words}", *figures)
    return Verdict("good", f"GOOD: {words}", *figures)
