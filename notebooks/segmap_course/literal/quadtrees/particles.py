"""A filter of particles, as B 2.2.2 sketches it: each is a pose, and weighs what the scan says."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from math import dist, exp, floor, log, pi, sqrt
from typing import TYPE_CHECKING

from ..lines import Point, placed
from .hypotheses import effective_number, systematic

if TYPE_CHECKING:
    from numpy.random import Generator

Pose = Sequence[float]


def fit(value: Callable[[Point], float], points: Sequence[Point], pose: Pose) -> float:
    """Geometric mean over the ends of a scan of .9 times what each is worth, and .1.

    `value` says what an end is worth at a place, 0 to 1; points are metres in the robot's frame.

    Examples
    --------
    >>> fit(lambda place: 1.0, [(1.0, 0.0)], (0.0, 0.0, 0.0))
    1.0
    """
    logs = [log(0.9 * value(placed(point, pose)) + 0.1) for point in points]
    return exp(sum(logs) / len(logs))


def weighed(weights: Sequence[float], fits: Sequence[float], beams: float = 10) -> list[float]:
    """Weights times the fits, as often as a scan has independent beams; they sum to 1.

    Examples
    --------
    >>> weighed([0.5, 0.5], [0.8, 0.4], beams=2)
    [0.8, 0.2]
    """
    each = [w * f**beams for w, f in zip(weights, fits, strict=True)]
    return [w / sum(each) for w in each]


def enough(
    poses: Sequence[Pose], size: Pose = (0.25, 0.25, 0.2), least: int = 300, error: float = 0.05
) -> int:
    """How many of the first particles are enough for the cells in which they lie (Fox 2003).

    `size` is that of a cell, metres and radians.

    Examples
    --------
    >>> enough([(0.0, 0.0, 0.0)] * 1000), enough([(k, 0.0, 0.0) for k in range(1000)])
    (300, 1000)
    """
    cells = set()
    for count, pose in enumerate(poses, 1):
        cells.add(tuple(floor(p / s) for p, s in zip(pose, size, strict=True)))
        k = max(len(cells) - 1, 1)
        a = 2 / (9 * k)
        if count >= max(k / (2 * error) * (1 - a + sqrt(a) * 2.326) ** 3, least):
            return count
    return len(poses)


def moved(pose: Pose, before: Pose, now: Pose, rng: Generator, found: bool) -> Pose:
    """A particle after the way from one odometry to the next, with an error of its own.

    Once the robot is found the error has the tails of wheels that slip.
    """
    draw = partial(rng.standard_t, 3) if found else rng.standard_normal
    x, y = placed((now[0] - before[0], now[1] - before[1]), (0.0, 0.0, -before[2]))
    turn, way = (now[2] - before[2] + pi) % (2 * pi) - pi, dist(before[:2], now[:2])
    x, y = (part + draw() * (0.02 + 0.1 * way) for part in (x, y))
    turn += draw() * (0.01 + 0.05 * way + 0.1 * abs(turn))
    return *placed((x, y), pose), (pose[2] + turn + pi) % (2 * pi) - pi


def localize(
    scans: Iterable[tuple[Sequence[Point], Pose]],
    value: Callable[[Point], float],
    fresh: Callable[[Sequence[Point], int], list[Pose]],
    *,
    rng: Generator,
    particles: int = 1000,
    on_lines: Callable[[Sequence[Point], int], Sequence[Point]] = lambda points, least: points,
) -> Iterator[tuple[list[Pose], list[float], float]]:
    """Particles, their weights, and how well the scans fit, after each scan (Dellaert et al. 1999).

    A scan is its ends, metres in the robot's frame, and the odometry. `value` is that of `fit`;
    `fresh` gives so many poses at the places that explain the ends: a search. `on_lines` gives
    those of the ends that lie on lines of their scan, all where it has fewer lines than so many:
    where not all fit, these are asked. The fit is a mean over the last scans at one place; before
    the first it is 0.8.

    Examples
    --------
    >>> import numpy as np
    >>> scans = [([(1.0, 0.0)], (0.0, 0.0, 0.0))] * 2
    >>> there = lambda points, count: [(0.0, 0.0, 0.0)] * count
    >>> steps = localize(scans, lambda place: 1.0, there, rng=np.random.default_rng(1))
    >>> [(len(poses), round(fit, 2)) for poses, _, fit in steps]
    [(1000, 0.89), (1000, 0.95)]
    """
    poses: list[Pose] = []
    weights: list[float] = []

    def fit_of_best(
        points: Sequence[Point], poses: Sequence[Pose], fits: Sequence[float], lines: int
    ) -> float:
        best = max(fits, default=0.0)
        if not poses or best >= 0.93:
            return best
        return fit(value, on_lines(points, lines), poses[fits.index(best)])

    before, lately, wait, patience, least = None, 0.8, 0, 1, 0.93
    for points, odometry in scans:
        if before is not None:
            poses = [moved(pose, before, odometry, rng, least == 0.8) for pose in poses]
        fits = [fit(value, points, pose) for pose in poses]
        best, before, wait = max(fits, default=0.0), odometry, wait - 1
        here = [pose for pose, its in zip(poses, fits, strict=True) if its == best]
        now = sqrt(lately * fit_of_best(points, poses, fits, 1 if least == 0.8 else 6))
        if now < least and wait <= 0:  # perhaps it is elsewhere
            others = fresh(points, particles)
            there = [fit(value, points, pose) for pose in others]
            share, patience = 1 - best / max(there, default=1.0), min(2 * patience, 16)
            if others and share > 0.05:
                goal = others[there.index(max(there))]
                if not any(at_one_place(pose, goal) for pose in here):
                    lately, least = 0.8, 0.93  # nothing is known of that place yet
                now = sqrt(lately * fit_of_best(points, others, there, 1 if least == 0.8 else 6))
                weights = [(1 - share) * w for w in weights] + [share / len(there)] * len(there)
                poses, fits, patience = poses + others, fits + there, 1
            wait = patience = patience if poses else 1
        lately = now
        weights = weighed(weights, fits, len(points) / 3)
        yield poses, weights, lately
        living = at_places(poses, weights)
        least = 0.8 if len(living) == 1 and lately >= least else least  # found
        poses, weights = redrawn(poses, weights, living, particles, rng)


def at_one_place(one: Pose, other: Pose) -> bool:
    """Whether two poses lie no farther apart than half a metre, and half a radian.

    Examples
    --------
    >>> at_one_place((0.0, 0.0, 3.1), (0.3, 0.0, -3.1))
    True
    """
    turn = abs((one[2] - other[2] + pi) % (2 * pi) - pi)
    return dist(one[:2], other[:2]) <= 0.5 and turn <= 0.5


def at_places(poses: Sequence[Pose], weights: Sequence[float]) -> list[list[int]]:
    """Which particles are at each place, but at those that hold less than 0.03 of the weight.

    Examples
    --------
    >>> at_places([(0.0, 0.0, 0.0), (3.0, 0.0, 0.0), (0.1, 0.0, 0.0)], [0.4, 0.5, 0.1])
    [[1], [0, 2]]
    """
    unplaced, places = set(range(len(poses))), []
    while unplaced:
        top = poses[max(sorted(unplaced), key=lambda k: weights[k])]
        near = [k for k in sorted(unplaced) if at_one_place(poses[k], top)]
        places.append(near)
        unplaced -= set(near)
    return [place for place in places if sum(weights[k] for k in place) >= 0.03]


def redrawn(
    poses: Sequence[Pose],
    weights: Sequence[float],
    places: Sequence[Sequence[int]],
    particles: int,
    rng: Generator,
) -> tuple[list[Pose], list[float]]:
    """The particles of each place drawn anew where few hold its weight: no place dies by chance.

    Examples
    --------
    >>> redrawn([(0.0, 0.0, 0.0), (3.0, 0.0, 0.0)], [0.5, 0.5], [[0], [1]], 300, None)
    ([(0.0, 0.0, 0.0), (3.0, 0.0, 0.0)], [0.5, 0.5])
    """
    faded = [sum(weights[k] for k in place) ** 0.8 for place in places]  # what is known fades
    drawn, new = [], []
    for place, part in zip(places, faded, strict=True):
        share, total = part / sum(faded), sum(weights[k] for k in place)
        own = [weights[k] / total for k in place]
        count = max(int(particles * (share + 1 / len(places)) / 2), 1)
        chosen = [poses[k] for k in place]
        if len(place) > count or effective_number(own) < len(place) / 2:
            taken = systematic(own, rng.uniform(), count)
            chosen = [chosen[taken[k]] for k in rng.permutation(count)]
            chosen = chosen[: enough(chosen)]
            own = [1 / len(chosen)] * len(chosen)
        drawn += chosen
        new += [share * w for w in own]
    return drawn, new
