"""Where a robot is on the maps of real logs: `localize`, and the Kalman filter.

*Right* is within 0.3 m of the log's own corrected poses (of Malaga, of the pose graph's: its file
has less than half of them); *found wrong* is found and is not right.
"""

from collections.abc import Callable, Iterator

import numpy as np

from segmap import Log, SegmentMap, alignment, build_map, load, quadtree, read, reduction
from segmap.arrays import Array
from segmap.matching import localize, localize_ekf

from .measure import SHARED, Row, missing

#: Kind of a map -> the map of a log at its own poses.
MAPS: dict[str, Callable[[Log], SegmentMap | quadtree.QuadtreeMap]] = {
    "segments": lambda log: build_map(log, log.truth),
    "least_cost": lambda log: SegmentMap(reduction.least_cost(MAPS["segments"](log)).segments),
    "quadtree": lambda log: quadtree.build_map(log, log.truth, resolution=0.05),
}
#: Every third scan is asked, unless fewer are left.
LEAST_ASKED = 200
#: A place so near to the truth is right, metres.
RIGHT_M = 0.3


def rows() -> Iterator[Row]:
    for name in ("malaga", "intel", "fr079"):
        log = real(name)
        if log is None:
            yield from missing(f"{name}, where is the robot")
            continue
        if name != "fr079":  # it has no odometry
            yield Row(f"{name}, Kalman filter on least_cost", kalman(log))
        for kind, map_of in MAPS.items():
            goal = f">= {0.85 if kind == 'quadtree' else 0.9} of right, 0 wrong"
            yield Row(f"{name}, {kind}, own scans", told(map_of(log), every_third(log)), goal)
            if name != "intel":
                other = told(map_of(log[::2]), every_third(log[1::2]))
                yield Row(f"{name}, {kind}, map of every second scan", other, goal)
            far = log.truth[:, np.ptp(log.truth[:, :2], axis=0).argmax()]
            for side, half in (("one", far < np.median(far)), ("other", far >= np.median(far))):
                away = told(map_of(taken(log, half)), every_third(taken(log, ~half)))
                yield Row(f"{name}, {kind}, map of {side} half, robot beside it", away, "0 wrong")


def real(name: str) -> Log | None:
    """A log with a pose for each scan; None where it is not here."""
    if name == "malaga":
        log = load(name)
        return Log(name, list(log), alignment.pose_graph(log).poses)
    path = SHARED / "data" / f"{name}.log.gz"
    return alignment.prepared(read(path)) if path.exists() else None


def taken(log: Log, which: Array) -> Log:
    """The scans of a log for which `(k,)` is true."""
    rows = np.flatnonzero(which)
    return Log(log.name, [log[int(k)] for k in rows], log.truth[rows])


def every_third(log: Log) -> Log:
    """Every third scan, or all where that leaves few."""
    return log if len(log) < 3 * LEAST_ASKED else log[::3]


def told(map: SegmentMap | quadtree.QuadtreeMap, log: Log) -> str:
    """How often the robot is found where it is right, how often found elsewhere."""
    beliefs = list(localize(map, log, rng=np.random.default_rng(1)))
    off = np.hypot(*(np.array([belief.pose for belief in beliefs]) - log.truth)[:, :2].T)
    found, right = np.array([belief.found for belief in beliefs]), off < RIGHT_M
    hits, wrong = int((found & right).sum()), off[found & ~right]
    share = f"{hits} of {right.sum()} right found ({hits / max(right.sum(), 1):.2f})"
    far = f", up to {wrong.max():.1f} m off" if len(wrong) else ""
    return f"{share}, {len(log)} asked; {len(wrong)} found wrong{far}"


def kalman(log: Log) -> str:
    """Errors and NEES of the Kalman filter on the log's own walls, and when it says it is lost."""
    map, start = MAPS["least_cost"](log), np.diag([0.05, 0.05, 0.02]) ** 2
    states = list(localize_ekf(map, log, log.truth[0], start))
    off = np.hypot(*(np.array([state.pose for state in states]) - log.truth)[:, :2].T)
    nees = [state.nees(pose) / 3 for state, pose in zip(states, log.truth, strict=True)]
    lost = np.array([state.lost for state in states])
    away = f", {lost[off > 0.5].mean():.2f} of those over 0.5 m off" if (off > 0.5).any() else ""
    return (
        f"{off.mean():.3f} m off, at most {off.max():.2f}; NEES/3 {np.median(nees):.2f} in the "
        f"median, {np.mean(nees):.1f} in the mean; lost at {lost.mean():.2f} of all scans{away}"
    )
