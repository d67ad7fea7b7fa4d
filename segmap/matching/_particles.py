"""Mapping by particles, each with pose, likelihood, weight and a map of its own."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from copy import deepcopy
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import arrays
from ..arrays import Array, Count, Quantity, Share, at_most, checked
from ..compiled import work_time
from ..poses.motions import between, compose, transform
from ..quadtree import QuadtreeMap
from ..scans import LaserScan
from ..simulation import OdometryNoise
from ._field import DistanceField, NothingNear
from ._likelihoods import ANYTHING
from ._live_map import FOUND, insert_placed, overlap_of
from ._mapping import _warm, naming_scan
from ._matchers import Prepared, field_score, hill_climb
from ._weights import BEAM_WEIGHT_PART, effective_number, systematic

#: Beams of a scan that are weighed, evenly chosen: neighbours meet one wall, and would say the same
#: thing again and again.
WEIGHED_BEAMS = 60
#: The end of a beam lies about so far from a wall of the map, metres.
PARTICLE_SIGMA_M = 0.05
#: Poses are drawn and weighed where the robot has moved so far, metres or radians: scans from one
#: place err alike. In between each particle stands on its peak.
WEIGHING_STEP = 0.3, 0.3
#: Around a peak its likelihood is asked at 3 x 3 x 3 poses, so far apart, metres and radians: a
#: cell of the usual map, and what moves an end at 5 m as far.
PEAK_STEP = np.array([0.05, 0.05, 0.01])
LATTICE = np.array([(x, y, turn) for x in (-1, 0, 1) for y in (-1, 0, 1) for turn in (-1, 0, 1)])
#: A wheel errs by so much however short the way, metres and radians.
SLIP = np.array([0.002, 0.002, 0.001])
#: A robot without odometry moves by so much from scan to scan, metres and radians.
NO_ODOMETRY_STEP = np.array([0.1, 0.1, 0.05])
#: While a robot turns fast its odometry may be late. Turns from scan to scan above this, radians,
#: are fast: a start is good to 0.3.
FAST_TURN_RAD = 0.3
#: The matcher tries more headings where less than this share of a scan lies on the map.
GOOD_OVERLAP = 0.75
#: Turns that are added to the predicted heading for more starts of the matcher, radians.
LATE_TURNS = np.outer([0, -0.9, -0.6, -0.3, 0.3, 0.6, 0.9], [0, 0, 1])
#: At most so many particles, since each has a map of its own in memory.
MOST_PARTICLES = 10_000

#: A pose that the matcher has found, and the field; None where nothing is near.
Peak = tuple[Array, DistanceField | None]


class Particles(NamedTuple):
    """The particles after one scan.

    `poses`, `(n, 3)`, are the robot's in the map, metres and radians; `weights`, `(n,)`, sum to 1;
    `parents`, `(n,)`, says which particle after the scan before each one goes on from. `best` is
    the particle whose whole way is the most likely one, and `overlap` the share of the scan that
    lay on its map; `seconds` is what the whole step took.

    Examples
    --------
    >>> here = Particles(np.zeros((4, 3)), np.array([0.5, 0.5, 0, 0]), np.arange(4), 0, 1.0, 0.1)
    >>> float(here.effective), here.found
    (2.0, True)
    """

    poses: Array
    weights: Array
    parents: NDArray[np.int64]
    best: int
    overlap: float
    seconds: float

    @property
    def pose(self) -> Array:
        """Pose of the best particle, (3,) array, metres and radians."""
        return self.poses[self.best]

    @property
    def effective(self) -> float:
        """How many particles count: all where weights are equal, 1 where one has all the weight."""
        return effective_number(self.weights)

    @property
    def found(self) -> bool:
        """Whether the scan lies on the map of the best particle, as in `Step`."""
        return self.overlap >= FOUND


@checked
def particle_mapping(
    log: Iterable[LaserScan],
    *,
    particles: Annotated[Count, at_most(MOST_PARTICLES)] = 30,
    rng: np.random.Generator,
    odometry: OdometryNoise | None = OdometryNoise(),
    noise: Annotated[float, Quantity("", least=0, most=100)] = 1.0,
    resample: Share = 0.5,
    map: QuadtreeMap | None = None,
    start: ArrayLike = (0.0, 0.0, 0.0),
) -> Iterator[Particles]:
    """Follow many ways that the robot may have taken, each with its own map (Grisetti et al. 2007).

    A particle moves by the odometry, and `hill_climb` seeks the peak on its own map; from other
    headings too where the odometry turns fast or the scan does not lie on the map. Every 0.3 m the
    next pose is drawn about the peak, as widely as the likelihood around it and the errors of the
    odometry say, and the particle is weighed by how well the scan fits. Where few particles hold
    most of the weight, they are drawn anew: the heavy ones several times, each with a copy of its
    map. So a way that fits when the robot comes back replaces those that do not.

    With a scan every 0.85 m of Intel and FR079 and 30 particles it errs by 0.4 to 0.5 and 0.07 m in
    the mean, where the odometry errs by 26 and 2.1 m.

    Parameters
    ----------
    odometry : OdometryNoise or None
        Errors of the odometry of the scans; it is where the matcher begins. Where there is none,
        that is the pose before, as in `map_scans`.
    noise : float
        How much of the way drawn from the peak is gone: with 0 all particles stay on their peaks
        and do the same. One particle without noise and odometry does what `map_scans` does.
    resample : float
        Particles are drawn anew where the effective number is below this share of them: never
        with 0, after nearly every scan with 1.
    map : QuadtreeMap or None
        Each particle begins with a copy of it; after each scan it is a copy of the best one's. A
        new one with cells of 5 cm by default.
    start
        As in `map_scans`.

    Yields
    ------
    Particles
        After each scan; `particle_paths` puts them together.

    Raises
    ------
    ValueError
        As `map_scans` does; the map is then as before that scan.

    Examples
    --------
    >>> from segmap import load
    >>> steps = list(particle_mapping(load("room")[:5], particles=4, rng=np.random.default_rng(1)))
    >>> steps[-1].poses.shape, particle_paths(steps).shape
    ((4, 3), (4, 5, 3))
    """
    pose = arrays.pose(start, "start")
    tree = QuadtreeMap(resolution=0.05) if map is None else arrays.instance(map, "map", QuadtreeMap)
    if not arrays.is_iterable(log):
        raise ValueError(f"log must be a Log, or give scans one by one, got {type(log).__name__}")
    if odometry is not None:
        arrays.instance(odometry, "odometry", OdometryNoise)
    return _steps(log, tree, np.tile(pose, (particles, 1)), odometry, noise, resample, rng)


def _steps(
    log: Iterable[LaserScan],
    map: QuadtreeMap,
    poses: Array,
    odometry: OdometryNoise | None,
    noise: float,
    resample: float,
    rng: np.random.Generator,
) -> Iterator[Particles]:
    """Algorithm 1 of the paper; what it does last for a scan is done first for the next one."""
    _warm(field_score)
    count, settled, drawn = len(poses), False, poses
    wheels = wheels_drawn = None  # odometry at the scan before, and where poses were drawn last
    maps = [deepcopy(map) for _ in range(count)]
    recent, likely = np.zeros(count), np.zeros(count)  # logarithms: since drawn anew, of all
    for k, scan in enumerate(log):
        begun = work_time()
        with naming_scan(scan, k):
            points, parents = scan.points(), np.arange(count)
            # 1. Resample, where few particles hold most of the weight
            if effective_number(_weights(recent)) < resample * count:
                parents = systematic(_weights(recent), rng.random())
                chosen = zip(parents, np.diff(parents, prepend=-1) == 0, strict=True)
                maps = [deepcopy(maps[at]) if again else maps[at] for at, again in chosen]
                poses, drawn = poses[parents], drawn[parents]
                likely, recent = likely[parents], np.zeros(count)
            # 2. Propose: where the odometry leads, then the peak beside it on the own map
            step, here = None, None if odometry is None else scan.odometry
            if here is not None:
                step, wheels = None if wheels is None else between(wheels, here), here
            if step is not None:
                poses = compose(poses, step)
            best = int(np.argmax(likely))
            if len(points) and settled:
                own = zip(maps, poses, strict=True)
                peaks = [_climb(*each, points, _turns_to_try(step)) for each in own]
                poses = np.array([peak for peak, _ in peaks])
                x, y, turn = np.abs(between(drawn[best], poses[best]))
                if np.hypot(x, y) > WEIGHING_STEP[0] or turn > WEIGHING_STEP[1]:
                    # 3. Weigh each particle by its likelihood about the peak, and draw its pose
                    wide = NO_ODOMETRY_STEP
                    if odometry is not None and wheels is not None and wheels_drawn is not None:
                        wide = odometry_deviation(between(wheels_drawn, wheels), odometry)
                    poses, weight = _draw_about(peaks, points, wide, noise, rng)
                    recent, likely = recent + weight, likely + weight
                    drawn, wheels_drawn, best = poses.copy(), wheels, int(np.argmax(likely))
            # 4. Map
            overlap = overlap_of(maps[best], points, poses[best])
            for own_map, pose in zip(maps, poses, strict=True):
                insert_placed(own_map, None, scan, pose, free=False)
            map.become(deepcopy(maps[best]))
        if len(points) and not settled:
            settled, drawn, wheels_drawn = True, poses.copy(), wheels
        seconds = work_time() - begun
        yield Particles(poses.copy(), _weights(recent), parents, best, overlap, seconds)


def _draw_about(
    peaks: Sequence[Peak], points: Array, wide: Array, noise: float, rng: np.random.Generator
) -> tuple[Array, Array]:
    """A pose about each peak, `(n, 3)`, and the logarithm of the weight that each one gains."""
    poses, gained = [], []
    for peak, field in peaks:
        around = compose(peak, LATTICE * PEAK_STEP)
        covariance, weight = proposal(_log_likelihood(field, points, around), wide)
        gained.append(BEAM_WEIGHT_PART * weight)
        if noise > 0:
            away = np.linalg.cholesky(covariance) @ rng.standard_normal(3)
            peak = compose(peak, noise * away)
        poses.append(peak)
    return np.array(poses), np.array(gained)


def _turns_to_try(step: Array | None) -> list[Array]:
    """Turns from which the matcher begins, and those where it finds nothing then, `(t, 3)` each."""
    if step is None:
        return [LATE_TURNS[:1]]
    return [LATE_TURNS] if abs(step[2]) > FAST_TURN_RAD else [LATE_TURNS[:1], LATE_TURNS]


def _climb(map: QuadtreeMap, start: Array, points: Array, tries: Sequence[Array]) -> Peak:
    """The pose that hill climbing finds from a start, and the field; the start with nothing near.

    More turns are tried where too little of the scan lies on the map, and kept if it then does.
    """
    answers = []
    for turns in tries:
        starts = start + turns
        try:
            field = DistanceField.around(map, points, starts)
        except NothingNear:
            return start, None
        values = field.scorer(points)
        score = Prepared(values, points, field_score)
        poses = np.array([hill_climb(map, points, each, score=score) for each in starts])
        answers.append((poses[np.argmax(values(poses))], field))
        if len(tries) == 1 or overlap_of(map, points, answers[-1][0]) >= GOOD_OVERLAP:
            return answers[-1]
    return answers[0]


def _log_likelihood(field: DistanceField | None, points: Array, poses: Array) -> Array:
    """Of points `(n, 2)` at poses `(k, 3)`, metres and radians: (k,) array."""
    few = points[np.linspace(0, len(points) - 1, min(WEIGHED_BEAMS, len(points))).astype(np.int64)]
    ends = transform(poses, few).reshape(-1, 2)
    each = np.column_stack([ends, np.zeros(len(ends))])
    away, point = np.full(len(ends), -np.inf), np.zeros((1, 2))
    away = away if field is None else field.scorer(point)(each)  # each end as a scan of one point
    near = np.exp(-(away**2) / (2 * PARTICLE_SIGMA_M**2))
    return np.asarray(np.log((1 - ANYTHING) * near + ANYTHING).reshape(len(poses), -1).sum(1))


def proposal(values: Array, wide: Array) -> tuple[Array, float]:
    """Covariance of the pose about a peak, (3, 3) array, and the logarithm of the weight.

    A greedy matcher has no covariance: a parabola fits the log likelihood on the lattice, (27,)
    array, best. What it leaves open, along a corridor say, the odometry bounds, by its standard
    deviations `wide`, (3,) array. The weight is the integral of both, eq. 12 of the paper. All in
    the frame of the peak, metres and radians.
    """
    bend = (LATTICE.T * values) @ LATTICE / 12
    bend[np.diag_indices(3)] = (LATTICE.T**2 - 2 / 3) @ values / 3
    size, axes = np.linalg.eigh(-bend)
    scan = axes * np.maximum(size, 0) @ axes.T / np.outer(PEAK_STEP, PEAK_STEP)
    covariance = np.linalg.inv(scan + np.diag(wide**-2))
    shrunk = np.linalg.slogdet(covariance)[1] / 2 - np.log(wide).sum()
    return covariance, float(values[len(values) // 2] + shrunk)


def odometry_deviation(step: Array, odometry: OdometryNoise) -> Array:
    """Standard deviations of a step `(3,)` of the odometry, (3,) array, metres and radians."""
    way, turn = np.hypot(*step[:2]), abs(step[2])
    along = odometry.distance_noise * np.sqrt(way)
    about = odometry.turn_noise**2 * turn + odometry.heading_noise**2 * way
    about += (odometry.turn_bias * turn) ** 2
    return np.hypot([along, along, np.sqrt(about)], SLIP)


def _weights(logarithms: Array) -> Array:
    """Weights `(n,)` that sum to 1."""
    parts = np.exp(logarithms - logarithms.max())
    return np.asarray(parts / parts.sum())


def particle_paths(steps: Sequence[Particles]) -> Array:
    """The way of each particle that is left in the end, `(n, k, 3)`, metres and radians.

    Backwards from the last scan to parents and their parents: relatives share their past.

    Examples
    --------
    >>> first = Particles(np.zeros((2, 3)), np.full(2, 0.5), np.arange(2), 0, 1.0, 0.1)
    >>> last = first._replace(poses=np.ones((2, 3)), parents=np.array([1, 1]))
    >>> particle_paths([first, last])[:, :, 0]
    array([[0., 1.],
           [0., 1.]])
    """
    listed = isinstance(steps, list | tuple) and len(steps) > 0
    if not listed or not all(isinstance(step, Particles) for step in steps):
        raise ValueError("steps must be a list of what particle_mapping yields, not empty")
    at, paths = np.arange(len(steps[-1].poses)), []
    for step in reversed(steps):
        paths.append(step.poses[at])
        at = step.parents[at]
    return np.stack(paths[::-1], 1)
