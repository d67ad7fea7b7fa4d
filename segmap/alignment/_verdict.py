"""The verdict on a map: whether its scans are placed, whether that is sure, what speaks against."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from ..arrays import Array
from ..display import counted
from ..metrics import doubled_walls
from ..quadtree import QuadtreeMap, smeared_walls
from ..scans.causes import Cause
from ..segments import SegmentMap

if TYPE_CHECKING:
    from ._result import Alignment

#: Below this share of placed scans the log gives no map.
LEAST_PLACED_SHARE = 0.25
#: A good map holds this share of the scans: the real logs of the benchmarks have 0.99 and more.
PLACED = 0.9
#: Of the scans that are placed at least so many are sure, in the whole map or relative to those
#: near by: a large building may be right in each of its parts and bent as a whole.
SURE_SHARE = 0.5
#: More walls are not doubled in a good map: see `metrics.doubled_walls` for what was measured.
MOST_DOUBLED_SHARE = 0.25
#: Nor are more of the occupied cells of its quadtree smeared: see `quadtree.smeared_walls`.
SMEARED = 0.2

#: So many scans must count before a log can be called unsure as a whole.
LEAST_COUNTED_SCANS = 10
#: Where none of them is sure, half must be known to this standard deviation, metres: a map whose
#: rooms may lie anywhere is none.
UNKNOWN_M = 1.0
#: A good map promises no more than this, metres: half of a door.
PROMISE_M = 0.5

Grade = Literal["good", "doubtful", "not a map"]


@dataclass(frozen=True)
class Verdict:
    """A judgement of a map as one grade, as words, and as the figures behind both.

    Parameters
    ----------
    grade
        "not a map" where fewer than two scans of several are placed, fewer than a quarter, no wall
        is there, what was matched leaves poses free, or none of ten scans and more is sure and half
        of them may be over 2 m off.
        "doubtful" where less than nine tenths of the scans are placed, less than half of those are
        sure relative to those within 20 m, more than a quarter of the walls is doubled or a fifth
        of the quadtree smeared, nothing but the wheels places them, or a finding of the alignment
        makes it so.
    words
        One line for a user, which begins with the grade in capitals; what makes the map doubtful
        comes first.
    placed, scans
        Scans with evidence of their own (`Alignment.used`), and all of them.
    sure
        Of those placed, the ones that are in all likelihood less than half a metre off; None where
        the method does not tell.
    worst : metres, or None
        Twice the largest standard deviation of a scan that is placed; the words promise it where no
        cause speaks against the map.
    doubled
        Share of the walls that the map shows twice; None where no map was looked at.
    causes
        Of the findings that make the map doubtful, as `Cause` names them.
    smeared
        Share of the occupied cells of the quadtree whose walls are too thick; None without one.

    Notes
    -----
    What cannot be told: a log without odometry whose scans are mirrored; floors that are built
    alike; a robot that is lifted to a place that looks the same; rooms and corridors that repeat,
    where no odometry says how far the robot went.

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
    causes: tuple[str, ...] = ()
    smeared: float | None = None

    def __str__(self) -> str:
        return self.words


def judge(
    found: Alignment, map: SegmentMap | None = None, tree: QuadtreeMap | None = None
) -> Verdict:
    """The verdict on an alignment; with the maps that were made of it, also on their walls."""
    placed, scans, sure, worst, doubled = int(found.used.sum()), len(found), None, None, None
    certain = found.sure
    near = certain if found.local_spread is None else found.locally_sure
    off = np.zeros(0) if found.spread is None else 2 * found.spread[found.used]
    if found.spread is not None:
        sure, worst = int(certain.sum()), float(off.max(initial=0.0))
    if map is not None and len(map):
        share = doubled_walls(map, found.poses[:, :2] if map.sensors is None else None)
        doubled = share if np.isfinite(share) else None
    blurred = np.nan if tree is None else smeared_walls(tree)
    smeared = float(blurred) if np.isfinite(blurred) else None
    drawn = [  # words on walls that are drawn more than once, and whether these are too many
        (share > most, f"{100 * share:.0f} % of the walls {word}")
        for share, most, word in (
            (doubled, MOST_DOUBLED_SHARE, "doubled"),
            (smeared, SMEARED, "smeared"),
        )
        if share is not None
    ]
    told = f"{placed} of {counted(scans, 'scan')} placed"
    costly = [finding for finding in found.causes if finding.doubtful]
    causes = tuple(str(each.cause) for each in costly)
    causes += (str(Cause.DOUBLED),) * any(bad for bad, _ in drawn)
    figures = placed, scans, sure, worst, doubled, causes, smeared
    for finding in found.causes:
        if finding.cause in (Cause.NOT_MERGED, Cause.LEFT_FREE):
            return Verdict("not a map", f"NOT A MAP: {finding.words}", *figures)
    if placed < min(2, scans) or placed < LEAST_PLACED_SHARE * scans or not scans:
        return Verdict("not a map", f"NOT A MAP: {told}", *figures)
    if map is not None and not len(map) and smeared is None:
        return Verdict("not a map", f"NOT A MAP: {told}, but no wall found", *figures)
    if sure is not None and placed >= LEAST_COUNTED_SCANS and not (certain.any() or near.any()):
        middle = float(np.median(off))
        if not middle <= 2 * UNKNOWN_M:
            words = f"NOT A MAP: no scan is sure, half of them may be {middle:.1f} m off and more"
            return Verdict("not a map", f"{words}; {told}", *figures)
    said = [(placed < PLACED * scans, told)]  # and whether it speaks against the map
    said += [(True, finding.words) for finding in costly]
    if found.method == "odometry":
        said.append((True, "nothing but the wheels places them"))
    if sure is not None:
        local = int(near.sum())
        more = f" ({local} relative to those within 20 m)" if local > sure else ""
        said.append((local < SURE_SHARE * placed, f"{counted(sure, 'scan')} sure{more}"))
    grade: Grade = "doubtful" if any(bad for bad, _ in said + drawn) else "good"
    if worst and not causes and (within := _within(off, grade)):
        said.append((False, within))
    said += drawn
    against, rest = ([text for bad, text in said if bad is kind] for kind in (True, False))
    words = "; ".join(", ".join(texts) for texts in (against, rest) if texts)
    return Verdict(grade, f"{grade.upper()}: {words}", *figures)


def _within(off: Array, grade: Grade) -> str:
    """How far scans are off at most, `off` metres each; a good map promises no more than 0.5 m.

    That holds only for a map against which nothing speaks: what makes it wrong is in no deviation.
    """
    most, beyond = float(off.max()), int((off > PROMISE_M).sum())
    if most <= PROMISE_M or grade != "good":
        return f"all within {most:.2f} m"
    return f"all but {beyond} within {PROMISE_M:g} m" if beyond < len(off) else ""
