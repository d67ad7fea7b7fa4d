"""What every alignment method returns, the runner that calls it, and the trail that most lay."""

from __future__ import annotations

import inspect
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import wraps
from typing import TYPE_CHECKING, Any, NamedTuple, ParamSpec

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import arrays
from ..arrays import Array, Radians, checked
from ..compiled import work_time
from ..display import Pictured
from ..extraction import extract_polylines
from ..poses.motions import between, compose
from ..scans import LaserScan, Log
from ..scans.causes import Finding, Unmatched
from ..scans.motion import rests, skew_warning
from ..scans.odometry import contradictions, promised_under
from ..segments import SegmentMap, length
from ._verdict import SURE_M, Verdict, judge
from .graph import Graph, loops_of

if TYPE_CHECKING:
    import pandas as pd

P = ParamSpec("P")


@dataclass(frozen=True, eq=False, repr=False)
class Match:
    """How one scan lies on another, or why that could not be told.

    Parameters
    ----------
    pose : (3,) array, metres and radians
        Pose of the current scan in the frame of the reference; where nothing matched, the start.
    covariance : (3, 3) array
        Of x, y (metres) and heading (radians); infinite on the diagonal where nothing matched.
    matched, reason
        Why nothing matched, in words; empty where it did.
    overlap
        Share of the current scan that found its partner, in [0, 1].
    free : (2,) array or None
        Unit vector, in the reference's frame, along which the reference does not fix the motion (a
        corridor's own direction); None where both directions are fixed.
    turns
        Whether nothing fixes a turn about some centre, as in a round room.
    unmatched
        The kind of the reason.
    """

    pose: Array
    covariance: Array
    matched: bool
    reason: str = ""
    overlap: float = 0.0
    free: Array | None = None
    turns: bool = False
    unmatched: Unmatched = Unmatched.NONE

    def __repr__(self) -> str:
        x, y, heading = self.pose.round(4) + 0.0
        place = f"{x:.6g} m, {y:.6g} m, {np.degrees(heading):.4g} deg"
        loose = "" if self.free is None else ", free along one direction"
        if not self.matched:
            return f"Match(none: {self.reason})"
        return f"Match({place}, overlap {self.overlap:.2f}{loose})"


def no_match(start: ArrayLike, why: Unmatched, reason: str = "", overlap: float = 0.0) -> Match:
    """A match that found nothing: it keeps the start, (3,) array, and knows nothing of the pose."""
    pose, unknown = np.array(start, float), np.diag(np.full(3, np.inf))
    return Match(pose, unknown, False, reason or str(why), overlap, unmatched=why)


class Appraisal(NamedTuple):
    """What an alignment says of itself; its fields are those of `Alignment`."""

    causes: tuple[Finding, ...] = ()
    spread: Array | None = None
    local_spread: Array | None = None
    proviso: str = ""


#: Stands for what is appraised once it is asked for.
NOT_GIVEN: Any = None


@dataclass(frozen=True, eq=False, repr=False)
class Alignment(Pictured):
    """One pose for each scan of a log, and which of them rest on a match.

    Parameters
    ----------
    poses : (k, 3) array, metres and radians
        Always finite: a scan that could not be matched carries the odometry on.
    used : (k,) bool array
        Whether the pose rests on the method's own evidence.
    seconds
        Time that the method took.
    method
        Its name in `alignment.METHODS`.
    reasons
        Why a scan was not used, in words; empty where it was.
    graph
        Edges, rejected loops and residuals of a pose graph.
    causes
        What of the log or of the method's assumptions does not hold: those of the log first.
    spread : (k,) array, metres, or None
        Standard deviation of each scan's place relative to all the others, where the method knows.
        No less than matches in real buildings err by, 2 cm and 0.3 degrees each: between the flat
        walls of a simulated one it says up to twenty times too much, unless `Tracking` says less.
    local_spread : (k,) array, metres, or None
        The same relative to the scans within 20 m. In a building of 300 m no place may be known in
        the whole, and each room be right.
    unmatched
        The kind of each reason.
    appraise
        Works out `causes`, `spread`, `local_spread` and `proviso` when the first of them is asked
        for, where they are not given.
    proviso
        Words to put behind what `spread` promises: what it holds under, and what it leaves out.

    Examples
    --------
    >>> Alignment(np.zeros((2, 3)), np.array([True, False]), 0.1, "backbone", ("", "turning"))
    Alignment(backbone: 2 scans, 1 used)
    """

    poses: Array
    used: NDArray[np.bool_]
    seconds: float
    method: str = ""
    reasons: tuple[str, ...] = ()
    graph: Graph | None = field(default=None)
    causes: tuple[Finding, ...] = field(default_factory=lambda: NOT_GIVEN)
    spread: Array | None = field(default_factory=lambda: NOT_GIVEN)
    local_spread: Array | None = field(default_factory=lambda: NOT_GIVEN)
    unmatched: tuple[Unmatched, ...] = ()
    appraise: Callable[[], Appraisal] = Appraisal
    proviso: str = field(default_factory=lambda: NOT_GIVEN)

    def __post_init__(self) -> None:
        for name in Appraisal._fields:
            if vars(self)[name] is NOT_GIVEN:
                del vars(self)[name]

    def __getattr__(self, name: str) -> Any:
        """A field that was not given, as it is appraised."""
        if name not in Appraisal._fields:
            raise AttributeError(f"an alignment has no {name!r}")
        vars(self).update(self.appraise()._asdict() | vars(self))
        return vars(self)[name]

    def __getstate__(self) -> dict[str, Any]:
        """The state of a copy, also by pickle, has all figures: it needs neither log nor graph."""
        state = {each.name: getattr(self, each.name) for each in fields(self)}
        return state | {"appraise": Appraisal}

    @property
    def doubt(self) -> str:
        """The words of all `causes`; empty where all is as assumed."""
        return "; ".join(map(str, self.causes))

    @property
    def sure(self) -> NDArray[np.bool_]:
        """Scans, (k,) bool, that are used and in all likelihood less than half a metre off.

        Two standard deviations of `spread`, where the method knows it, are less than that.
        """
        return self.used if self.spread is None else self.used & (self.spread <= SURE_M)

    @property
    def locally_sure(self) -> NDArray[np.bool_]:
        """The same relative to the scans within 20 m, (k,) bool, by `local_spread`."""
        near = self.local_spread
        return self.used if near is None else self.used & (near <= SURE_M)

    @property
    def trusted(self) -> Array:
        """The poses, (k, 3) array, metres and radians, with NaN for scans that were not used.

        `build_map` leaves those out.
        """
        return np.where(self.used[:, None], self.poses, np.nan)

    @property
    def verdict(self) -> Verdict:
        """Whether this makes a map, from the poses alone."""
        return judge(self)

    def verdict_on(self, map: SegmentMap) -> Verdict:
        """The verdict on the map of these poses before its reduction: it sees the walls as well."""
        return judge(self, arrays.instance(map, "map", SegmentMap))

    def why(self) -> pd.DataFrame:
        """How many scans were not used: a row for each reason, a column `scans`.

        `print(alignment.why().to_string())` shows long reasons whole.
        """
        import pandas as pd

        counts = Counter(reason for reason in self.reasons if reason)
        rows = sorted(((n, reason) for reason, n in counts.items()), reverse=True)
        return pd.DataFrame([n for n, _ in rows], [reason for _, reason in rows], ["scans"])

    def turned(self, angle: Radians) -> Alignment:
        """All poses turned about the origin, counter-clockwise."""
        turn = arrays.number(angle, "angle", unit="radians")
        return replace(self, poses=compose(np.array([0.0, 0.0, turn]), self.poses))

    def loops(self) -> pd.DataFrame:
        """The loops that a pose graph closed: a row for each, numbered from 0.

        Columns `first` and `second`, the scans at both ends; `residual`, what the poses leave of
        the loop, in standard deviations; the span, in `scans` and `metres` driven; and where both
        places lie, `x_first`, `y_first`, `x_second`, `y_second`, metres.
        """
        return loops_of(self.graph, self.poses)

    def __len__(self) -> int:
        return len(self.poses)

    def __repr__(self) -> str:
        doubt = f"; {self.doubt}" if self.doubt else ""
        return f"Alignment({self.method}: {len(self)} scans, {int(self.used.sum())} used{doubt})"


class Laid(NamedTuple):
    """The pose of a scan, (3,) array, metres and radians, and why it is not used, if it is not.

    Without a reason in words those of the kind count.
    """

    pose: Array
    unmatched: Unmatched = Unmatched.NONE
    reason: str = ""


class Outcome(NamedTuple):
    """What a method hands to the runner: a row for each scan, and what it may add."""

    laid: Sequence[Laid]
    graph: Graph | None = None
    appraise: Callable[[], Appraisal] = Appraisal


def alignment_method(method: Callable[P, Outcome]) -> Callable[P, Alignment]:
    """Make `method(log, *, thresholds) -> Outcome` a member of the family.

    Each call checks the log and the thresholds as they are declared, is timed, and raises
    RuntimeError where the method gave not one finite pose for each scan.
    """
    name = method.__name__

    @wraps(method)
    def run(*args: P.args, **kwargs: P.kwargs) -> Alignment:
        log = args[0] if args else kwargs.get("log")
        if not isinstance(log, Log):
            raise ValueError(f"log must be a Log, got {type(log).__name__}")
        begun = work_time()
        outcome = method(*args, **kwargs)
        seconds = work_time() - begun
        return checked_alignment(name, log, outcome, seconds)

    signature = inspect.signature(method).replace(return_annotation="Alignment")
    run.__signature__ = signature  # type: ignore[attr-defined]
    return checked(run)


def checked_alignment(
    name: str, scans: Sequence[LaserScan], outcome: Outcome, seconds: float
) -> Alignment:
    """The alignment of scans by a method of that name, checked."""
    poses = np.reshape([row.pose for row in outcome.laid], (-1, 3)).astype(float)
    if len(poses) != len(scans) or not np.isfinite(poses).all():
        raise RuntimeError(f"{name} must give a finite pose for each scan")
    unmatched = tuple(row.unmatched for row in outcome.laid)
    reasons = tuple(row.reason or str(row.unmatched) for row in outcome.laid)
    used = np.array([why is Unmatched.NONE for why in unmatched], bool)

    def appraise() -> Appraisal:
        """What the method says, behind what is known of the log and seen in it."""
        own, of_log = outcome.appraise(), getattr(scans, "causes", ())
        seen = skew_warning(scans, poses) + rests(scans, poses) + contradictions(scans, poses, used)
        proviso = promised_under(scans, poses, used)
        return own._replace(causes=(*of_log, *seen, *own.causes), proviso=proviso)

    copies = poses.copy(), used.copy()  # a user may edit these
    evidence = *copies, seconds, name, reasons, outcome.graph
    return Alignment(*evidence, unmatched=unmatched, appraise=appraise)


class Trail:
    """The poses laid so far, scan by scan, and the guess of the next one.

    The order of recording counts and no time: scans with equal or exchanged times give the same
    poses. The guess is the last pose and the odometry step; where the log holds no odometry for one
    of the two scans, the robot is assumed to repeat its last motion (constant velocity).

    The first scan gets the pose `first`; if None, its odometry pose; without odometry, the origin.
    It counts as not used if a reason `unmatched` is given.
    """

    def __init__(
        self, log: Log, first: Array | None = None, unmatched: Unmatched = Unmatched.NONE
    ) -> None:
        self.odometry = log.odometry
        self.laid: list[Laid] = []
        if len(log):
            start = self.odometry[0] if first is None else first
            self.place(start if np.isfinite(start).all() else np.zeros(3), unmatched)

    def pose(self, scan: int = -1) -> Array:
        """Pose of a scan, of the last one by default, (3,) array, metres and radians."""
        return self.laid[scan].pose

    def guess(self) -> Array:
        """Expected pose of the next scan, (3,) array, metres and radians."""
        return compose(self.pose(), self.step())

    def step(self) -> Array:
        """Expected motion to the next scan, (3,) array, metres and radians."""
        scan = len(self.laid)
        if self.has_odometry(scan):
            return between(self.odometry[scan - 1], self.odometry[scan])
        return between(self.pose(-2), self.pose()) if scan > 1 else np.zeros(3)

    def has_odometry(self, scan: int) -> bool:
        """Whether the log says how the robot moved to a scan from the one before."""
        return bool(np.isfinite(self.odometry[scan - 1 : scan + 1]).all())

    def place(
        self, pose: ArrayLike, unmatched: Unmatched = Unmatched.NONE, reason: str = ""
    ) -> None:
        """Append the pose of the next scan, (3,) array, metres and radians."""
        self.laid.append(Laid(np.asarray(pose, float), unmatched, reason))

    def carry(self, unmatched: Unmatched, reason: str = "") -> None:
        """Append the guess: the next scan could not be matched, for this reason."""
        self.place(self.guess(), unmatched, reason)


def long_segments(scan: LaserScan, min_length: float) -> Array:
    """Segments of a scan that are at least `min_length` metres long, `(n, 2, 2)`, robot frame."""
    segments = extract_polylines(scan.points(), closed=scan.whole_turn)
    return segments[length(segments) >= min_length]
