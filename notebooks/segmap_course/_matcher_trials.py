"""Every matcher with every score on one walk: how far they are off, and what the map costs."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from segmap.angles import wrap
from segmap.arrays import Array
from segmap.matching import MATCHERS, SCORES, map_scans
from segmap.quadtree import QuadtreeMap
from segmap.readers import data_file
from segmap.scans import Log
from segmap.simulation import (
    SICK_LMS200,
    URG_04LX,
    box,
    corridor_loop,
    drive,
    rectangular_room,
    simulate,
)

if TYPE_CHECKING:
    pass


@dataclass(frozen=True)
class Trial:
    """One walk mapped without odometry by one matcher and one score.

    The seed is that of the log's errors and of the matcher. Errors of position are in metres, their
    median and the largest, and the largest of the heading in radians. Leaves and bytes are those of
    the map: poses that agree leave a small one (B Fig. 6.17). A whole step, field, match and
    insertion, takes so many seconds in the median.

    Examples
    --------
    >>> load_trials()[0].matcher
    'hill climbing'
    """

    log: str
    matcher: str
    score: str
    seed: int
    median: float
    largest: float
    heading: float
    leaves: int
    nbytes: int
    seconds: float


def room_walk(scans: int = 200, *, seed: int = 0) -> Log:
    """Once round a furnished room of 4 m x 3 m, looking ahead, with a Hokuyo URG-04LX.

    With 200 scans the robot moves by 3 cm and turns by 3 degrees at most from one to the next;
    fewer are farther apart. The seed is that of the errors of sensor and wheels.

    Examples
    --------
    >>> room_walk(20)
    Log('room walk', 20 scans, odometry, truth)
    """
    if not scans >= 1:
        raise ValueError(f"scans must be at least 1, got {scans}")
    turn = np.linspace(0, 2 * np.pi, scans, endpoint=False)
    x, y = 2.05 + 1.05 * np.cos(turn), 1.45 + 0.65 * np.sin(turn)
    path = np.stack([x, y, np.arctan2(0.65 * np.cos(turn), -1.05 * np.sin(turn))], -1)
    rng = np.random.default_rng(seed)
    return simulate(room_walls(), path, sensor=URG_04LX, rng=rng, name="room walk")


def corridor_walk(*, seed: int = 0) -> Log:
    """Once round the corridor of `corridor_loop` and 3 m on, with a SICK that sees 8 m.

    The seed is that of the errors of sensor and wheels.

    Examples
    --------
    >>> corridor_walk()
    Log('corridor walk', 291 scans, odometry, truth)
    """
    corners = [(1, 1), (29, 1), (29, 11), (1, 11), (1, 1), (4, 1)]
    path = drive(corners, step=0.3, turn=np.radians(15))
    sensor, rng = replace(SICK_LMS200, max_range=8.0), np.random.default_rng(seed)
    return simulate(corridor_loop(), path, sensor=sensor, rng=rng, name="corridor walk")


def room_walls() -> Array:
    """Walls of the room of `room_walk`, `(16, 2, 2)`, metres: a cupboard, a table, a tilted crate.

    Examples
    --------
    >>> room_walls().max(axis=(0, 1))
    array([4., 3.])
    """
    cupboard, table = box(0.6, 0.7, (0.3, 2.65, 0)), box(0.8, 0.5, (3.6, 0.25, 0))
    crate = box(0.4, 0.3, (2.05, 1.5, 0.5))
    return np.concatenate([rectangular_room(4, 3), cupboard, table, crate])


def try_pair(log: Log, matcher: str, score: str, *, seed: int = 0) -> Trial:
    """Map a simulated log with known truth from its ranges alone, and judge it.

    The first true pose is the start, matcher and score are keys of `MATCHERS` and `SCORES`, and the
    seed is for a matcher that draws.

    Examples
    --------
    >>> trial = try_pair(room_walk()[:5], "hill climbing", "field")
    >>> trial.largest < 0.03
    True
    """
    for name, choices in ((matcher, MATCHERS), (score, SCORES)):
        if name not in choices:
            raise ValueError(f"{name!r} is none of {', '.join(choices)}")
    truth = log.truth
    if truth is None or not len(log) or not np.isfinite(truth).all():
        raise ValueError(f"{log.name} must have scans, and a true pose for every scan")
    map, chosen = QuadtreeMap(), MATCHERS[matcher](np.random.default_rng(seed))
    options = {"map": map, "start": truth[0], "free": True}  # no return: nothing is there
    steps = list(map_scans(log, matcher=chosen, score=SCORES[score], **options))
    away = np.array([step.pose for step in steps]) - truth
    place, heading = np.hypot(away[:, 0], away[:, 1]), np.abs(wrap(away[:, 2]))
    return Trial(
        log.name,
        matcher,
        score,
        seed,
        round(float(np.median(place)), 4),
        round(float(place.max()), 4),
        round(float(heading.max()), 4),
        len(map.leaves().x),
        map.nbytes,
        round(float(np.median([step.seconds for step in steps])), 5),
    )


def load_trials() -> list[Trial]:
    """All pairs of matcher and score on `room_walk`, as `make bench` wrote them.

    Examples
    --------
    >>> best = min(load_trials(), key=lambda trial: trial.largest)
    >>> best.matcher, best.largest < 0.05
    ('hill climbing', True)
    """
    import pandas as pd

    frame = pd.read_csv(data_file("records/matching.csv"))
    return [Trial(*row) for row in frame.itertuples(index=False)]


def load_columns(name: str) -> NDArray[np.void]:
    """Another record of matching that `make bench` wrote, as columns with names.

    "matching_growth" is what a score costs as the map grows (B table 6.3), "matching_exp1" poses
    and scores on a real log, "particles" how far off drives end; metres, radians and seconds.

    Examples
    --------
    >>> load_columns("matching_exp1").dtype.names
    ('scan', 'x', 'y', 'heading', 'score', 'beams', 'seconds')
    """
    path = data_file(f"records/{name}.csv")
    return np.genfromtxt(path, delimiter=",", names=True, dtype=None, encoding="utf-8")
