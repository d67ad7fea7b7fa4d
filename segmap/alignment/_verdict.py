"""The verdict on a map: whether its scans are placed, whether that is sure, what speaks against."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from ..display import plural
from ..metrics import doubled_walls
from ..scans.causes import Cause
from ..segments import SegmentMap

if TYPE_CHECKING:
    from ._result import Alignment

#: Below this share of placed scans the log gives no map.
LEAST_PLACED_SHARE = 0.25
#: A good map holds this share of the scans: the real logs of the benchmarks have 0.99 and more. Of
#: those it holds the same share is sure, in the whole map or relative to those near by: a large
#: building may be right in each of its parts and bent as a whole.
PLACED = 0.9

#: Where no scan is sure, half of them must have at most this standard deviation, metres: if its
#: rooms may lie anywhere, the log gives no map.
UNKNOWN_M = 1.0
#: A scan is sure where its standard deviation is at most this, metres: a tenth of a room. A good
#: map promises no more than twice as much, half of a door.
SURE_M = 0.25

#: Words of a map from one place.
ONE_LOOK = "one look; nothing confirms it"

Grade = Literal["good", "not checked", "doubtful", "not a map"]


@dataclass(frozen=True)
class Verdict:
    """A judgement of a map as one grade, as words, and as the figures behind both.

    Parameters
    ----------
    grade
        "not a map" where fewer than two scans of several are placed, fewer than a quarter, no wall
        is there, what was matched leaves poses free, or no scan is sure and half of them may be
        over 2 m off.
        "doubtful" where less than nine tenths of the scans are placed, or of those are sure
        relative to those within 20 m, nothing but the wheels places them, or a finding of the
        alignment makes it so: the poses do not keep what the matches say, say.
        "not checked" where nothing speaks against the poses and nothing confirms them: one look,
        or poses of a file that no match was compared with.
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
        Share of the walls that the map shows twice; None where no map was looked at. People and
        cheap lasers double walls that are right: it decides nothing.
    causes
        Of the findings that make the map doubtful, as `Cause` names them.

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

    def __str__(self) -> str:
        return self.words


def judge(found: Alignment, map: SegmentMap | None = None) -> Verdict:
    """The verdict on an alignment; with the map that was made of it, also on its walls."""
    placed, scans, sure, worst, doubled = int(found.used.sum()), len(found), None, None, None
    certain = found.sure
    near = certain if found.local_spread is None else found.locally_sure
    off = np.zeros(0) if found.spread is None else 2 * found.spread[found.used]
    if found.spread is not None:
        sure, worst = int(certain.sum()), float(off.max(initial=0.0))
    if map is not None and len(map):
        share = doubled_walls(map, found.poses[:, :2] if map.sensors is None else None)
        doubled = share if np.isfinite(share) else None
    summary = f"{placed} of {plural(scans, 'scan')} placed"
    costly = [finding for finding in found.causes if finding.doubtful]
    causes = tuple(str(each.cause) for each in costly)
    figures = placed, scans, sure, worst, doubled, causes
    # 1. No map
    none = [f.words for f in found.causes if f.cause in (Cause.NOT_MERGED, Cause.LEFT_FREE)]
    if placed < min(2, scans) or placed < LEAST_PLACED_SHARE * scans or not scans:
        none.append(summary)
    if map is not None and not len(map):
        none.append(f"{summary}, but no wall found")
    middle = float(np.median(off)) if placed and sure == 0 and not near.any() else 0.0
    if not middle <= 2 * UNKNOWN_M:
        none.append(f"no scan is sure, half of them may be {middle:.1f} m off and more; {summary}")
    if none:
        return Verdict("not a map", f"NOT A MAP: {none[0]}", *figures)
    # 2. What speaks against the map, and what does not
    against = [summary] if placed < PLACED * scans else []
    rest = [] if against else [summary]
    against += [finding.words for finding in costly]
    if found.method == "odometry":
        against.append("nothing but the wheels places them")
    if sure is not None:
        local = int(near.sum())
        more = f" ({local} relative to those within 20 m)" if local > sure else ""
        (against if local < PLACED * placed else rest).append(f"{plural(sure, 'scan')} sure{more}")
    # 3. What confirms it
    unchecked = [each.words for each in found.causes if each.cause is Cause.NOT_CHECKED]
    open_questions = [] if against else unchecked or [ONE_LOOK] * (placed == 1)
    grade: Grade = "doubtful" if against else "not checked" if open_questions else "good"
    if worst and not causes:  # what makes a map wrong is in no deviation
        beyond = int((off > 2 * SURE_M).sum()) if grade == "good" else 0
        most = f"all but {beyond} within {2 * SURE_M:g}" if beyond else f"all within {worst:.2f}"
        rest += [f"{most} m{found.proviso}"] if beyond < placed else []
    if doubled is not None:
        rest.append(f"{100 * doubled:.0f} % of the walls doubled")
    words = "; ".join(", ".join(texts) for texts in (against or open_questions, rest) if texts)
    return Verdict(grade, f"{grade.upper()}: {words}", *figures)
