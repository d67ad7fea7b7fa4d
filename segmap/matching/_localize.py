"""Where a robot is while it drives on a known map: particles that a search seeds."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Annotated, NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

from .. import arrays
from ..arrays import Array, Count, at_least, at_most, checked
from ..extraction import extract_polylines
from ..poses.motions import between, compose, wrap
from ..quadtree import QuadtreeMap
from ..scans import LaserScan
from ..segments import SegmentMap, point_distance
from ._field import either_map
from ._likelihoods import Likelihoods
from ._search import Uncertainty, at_one_place, distinct_places, sample_beams
from ._weights import BEAM_WEIGHT_PART, effective_number, systematic

#: A robot whose scans fit worse is lost: the wrong building has .50 to .75.
LOST_FIT = 0.7
#: Below this the map is searched: right places have .94, and .87 where much has moved.
DOUBTFUL_FIT = 0.8
#: A robot counts as found once the fit reaches this, and until the fit falls below `DOUBTFUL_FIT`:
#: what has moved makes wrong rooms fit to .92.
FOUND_FIT = 0.93
#: Places with less than this share of the weight are dropped; the robot is found where one remains.
#: For that the fits of a single scan must differ by 16 %, or those of a drive by 3.5 % each.
MIN_PLACE_WEIGHT = 0.03
#: Ends so near to a line of their own scan are asked, metres: five deviations of a good laser.
NEAR_LINE_M = 0.05
#: Where fewer ends lie on any line of their scan, all ends are asked.
LEAST_ON_LINES = 20
#: Until the robot is found a scan with fewer lines is asked as a whole: many corridors fit these.
LEAST_LINES = 6
#: What is known of two places counts with this power at the next scan. Maps are a little better at
#: one of two equal places (by 1 % of the fit where its walls err by 4 cm): with 1, a long drive
#: would make sure of it.
MEMORY = 0.8
#: Particles farther from the best one, metres, are at another place.
SAME_PLACE_M = 0.5
#: Particles turned by more from the best one, radians, are at another place.
SAME_PLACE_RAD = 0.5
#: Error of odometry at rest: metres, radians.
ERROR_AT_REST = np.array([0.02, 0.01])
#: Error of odometry for a metre: metres, radians.
ERROR_PER_M = np.array([0.1, 0.05])
#: Error of odometry for a radian: metres, radians.
ERROR_PER_RAD = np.array([0.0, 0.1])
#: How far a robot without odometry may get off its last motion, metres and radians.
UNKNOWN_MOTION = np.array([0.1, 0.1])
#: Degrees of freedom of these errors once the robot is found, by Student: wheels slip.
ERROR_DOF = 3
#: Sides of the cells in which particles are counted: metres, metres, radians.
KLD_CELL = np.array([0.25, 0.25, 0.2])
#: The error that Fox allows.
KLD_ERROR = 0.05
#: Quantile of the normal distribution that goes with it (99 %).
KLD_QUANTILE = 2.326
#: There are never fewer particles than this.
LEAST_PARTICLES = 300
#: Fresh particles come to all places that score at most so much less than the best.
PLACE_SCORE_MARGIN = 0.1
#: Fresh particles come to at most so many places.
MOST_FRESH_PLACES = 100
#: A place that fits better by less than this share is no reason to go there.
BETTER_FIT_SHARE = 0.05
#: Each search that brings nothing better doubles the scans to wait for the next, up to this.
LONGEST_WAIT_SCANS = 16

#: The scan before, none at the first, and this one.
TwoScans = tuple[LaserScan | None, LaserScan]


class Belief(NamedTuple):
    """What is known of the robot after a scan.

    `pose`, (3,) array, and `covariance`, (3, 3), metres and radians, are mean and spread of the
    particles at the likeliest place; `share` is that of the weight there; `fit` is how well the
    scans, or their lines, fit, 0 to 1: the mean over the last few, see `localize`. `reason` is
    empty where the robot is found, and says else "not yet: 3 places" or that it is lost;
    `uncertainty` is its kind.
    `poses` (n, 3) and `weights` (n,) are the particles.
    """

    pose: Array
    covariance: Array
    share: float
    fit: float
    reason: str
    poses: Array
    weights: Array
    uncertainty: Uncertainty = Uncertainty.NONE

    @property
    def found(self) -> bool:
        """Whether the robot is at the pose."""
        return self.uncertainty is Uncertainty.NONE


@checked
def localize(
    map: QuadtreeMap | SegmentMap,
    scans: Iterable[LaserScan],
    *,
    rng: np.random.Generator,
    particles: Annotated[Count, at_least(LEAST_PARTICLES), at_most(100_000)] = 1000,
    beams: Count = 60,
) -> Iterator[Belief]:
    """Keep track of a robot on a known map, from anywhere, and tell when it is lost.

    Monte Carlo localisation (Dellaert et al. 1999): particles move by odometry with its errors, and
    their weights are multiplied by what the scan is worth there. Each beam counts as a third: 60
    factors for one wall would make one particle certain. As many particles are drawn anew as the
    places need (Fox 2003).

    The weights are those of all beams. Whether the robot is found, not yet or lost is told by how
    well the scan fits at the best particle. A map of segments has no chairs and no legs, which stop
    a third of the beams of `malaga`: they fit nowhere. So where not all beams fit to 0.93, only
    those are asked that end within 0.05 m of a line of their own scan, by `extract_polylines`; all,
    where these are fewer than 20, or the robot is not found yet and sees fewer than 6 lines, which
    fit in many corridors. Fox, Burgard and Thrun (1999) leave beams out by their distance.

    The fit is a mean over the last scans at one place. Before the first it is 0.8, so that one look
    is never enough: corridors of one building agree to a few centimetres over metres.

    Where the scans fit badly, the whole map is searched, and where the robot is not yet found, when
    they fit to less than 0.93. Does the scan fit better there, so many fresh particles come there,
    as augmented filters draw anywhere; if that is another place, the mean begins anew.

    The robot is found where the scans leave one place only: drawing anew leaves each place its
    weight, so in a hall that maps onto itself by half a turn both stay. Where the walls of such a
    map err by some centimetres, the map itself can prefer the wrong place.

    Parameters
    ----------
    map
        As for `search`.
    scans
        A Log, at best from `alignment.prepared`, or scans one by one; without odometry the robot
        goes on as it went, from a stop to twice as fast, give or take 0.1 m.
    particles
        At most.
    beams
        Of each scan, spread evenly along the walls.

    Yields
    ------
    Belief
        After each scan.

    Raises
    ------
    ValueError
        At once for wrong arguments; later it names the scan that is no LaserScan.

    Examples
    --------
    >>> from segmap import load
    >>> from segmap.quadtree import build_map
    >>> log = load("room")
    >>> for belief in localize(build_map(log, log.truth), log[20:40], rng=np.random.default_rng(1)):
    ...     pass
    >>> belief.found, bool(np.hypot(*(belief.pose - log.truth[39])[:2]) < 0.05)
    (True, True)
    """
    either_map(map)
    if not arrays.is_iterable(scans):
        raise ValueError(f"scans must be a Log, or give scans, got {arrays.brief(scans)}")
    likelihoods = Likelihoods(map)

    def beliefs() -> Iterator[Belief]:
        poses, weights = np.zeros((0, 3)), np.zeros(0)
        before: LaserScan | None = None
        way, last = np.zeros(3), np.full(3, np.nan)
        fit, least, wait, patience = DOUBTFUL_FIT, FOUND_FIT, 0, 1
        for k, scan in enumerate(scans):
            arrays.instance(scan, f"scan {k}", LaserScan)
            poses = predict(poses, (before, scan), way, rng, found=least == DOUBTFUL_FIT)
            led = all(each is None or each.odometry is not None for each in (before, scan))
            before, ends = scan, scan.points()
            if not len(ends):
                yield estimate(poses, weights, at_places(poses, weights), fit, least)
                continue
            points = sample_beams(ends, beams)
            fits = likelihoods.fits(points, poses)
            best, wait, elsewhere = fits.max(initial=0.0), wait - 1, False
            earlier, fit = fit, np.sqrt(fit * fit_of_best(likelihoods, ends, poses, fits, least))
            if fit < (least if led else FOUND_FIT) and wait <= 0:
                fresh = fresh_poses(likelihoods, ends, particles, rng)
                there = likelihoods.fits(points, fresh)
                new = 1 - best / there.max(initial=best) if len(fresh) else 0.0
                if new > BETTER_FIT_SHARE:
                    if not led:  # it may have turned on the spot
                        tree = scipy.spatial.cKDTree(poses[:, :2])
                        near = tree.query(fresh[:, :2])[0] <= SAME_PLACE_M
                        if there[near].max(initial=0.0) > (1 - BETTER_FIT_SHARE) * there.max():
                            fresh, there = fresh[near], there[near]
                    goal, turn = fresh[np.argmax(there)], SAME_PLACE_RAD if led else np.pi
                    elsewhere = not at_one_place(
                        poses[fits == best], goal, SAME_PLACE_M, turn
                    ).any()
                    if elsewhere:
                        earlier, least = DOUBTFUL_FIT, FOUND_FIT
                    fit = np.sqrt(earlier * fit_of_best(likelihoods, ends, fresh, there, least))
                    weights = np.r_[(1 - new) * weights, np.full(len(fresh), new / len(fresh))]
                    poses, fits = np.concatenate([poses, fresh]), np.r_[fits, there]
                better = new > BETTER_FIT_SHARE or not len(poses)
                wait = patience = 1 if better else min(2 * patience, LONGEST_WAIT_SCANS)
            weights = weights * fits ** (BEAM_WEIGHT_PART * len(points))
            weights /= weights.sum() or 1.0
            places = at_places(poses, weights)
            belief = estimate(poses, weights, places, fit, least)
            least = DOUBTFUL_FIT if belief.found else least
            here = belief.pose if belief.found else np.full(3, np.nan)
            way, last = np.nan_to_num(between(last, here)) * (not elsewhere), here
            yield belief
            if places:
                poses, weights = redraw(poses, weights, places, particles, rng)

    return beliefs()


def predict(
    poses: Array, scans: TwoScans, way: Array, rng: np.random.Generator, *, found: bool
) -> Array:
    """Particles `(n, 3)`, metres and radians, after the way from one scan to the next.

    Without odometry each goes on by a share of the last `way`: the robot may stop, or go twice as
    fast. Once the robot is found the errors have long tails, since wheels slip; before, such tails
    would spread the particles over places that look alike.
    """
    before, scan = scans
    if before is None or not len(poses):
        return poses
    if before.odometry is None or scan.odometry is None:
        way, error = way * rng.uniform(0, 2, (len(poses), 1)), UNKNOWN_MOTION
    else:
        way = between(before.odometry, scan.odometry)
        error = ERROR_AT_REST + ERROR_PER_M * np.hypot(*way[:2]) + ERROR_PER_RAD * abs(way[2])
    noise = rng.standard_t(ERROR_DOF, poses.shape) if found else rng.standard_normal(poses.shape)
    return compose(poses, way + noise * error[[0, 0, 1]])


def on_lines(ends: Array, least: int) -> Array:
    """Ends `(k, 2)` of a scan `(n, 2)`, metres, on its own lines; all where it has fewer lines."""
    lines = extract_polylines(ends)
    near = (point_distance(ends[:, None], lines) <= NEAR_LINE_M).any(1)
    return ends[near] if len(lines) >= least and np.count_nonzero(near) >= LEAST_ON_LINES else ends


def fit_of_best(map: Likelihoods, ends: Array, poses: Array, fits: Array, least: float) -> float:
    """How well a scan fits at the pose `(n, 3)` that fits best: all ends, or those on its lines."""
    best = float(fits.max(initial=0.0))
    if not len(poses) or best >= FOUND_FIT:
        return best
    asked = on_lines(ends, LEAST_LINES if least == FOUND_FIT else 1)
    return float(map.fits(asked, poses[[np.argmax(fits)]])[0])


def fresh_poses(map: Likelihoods, ends: Array, count: int, rng: np.random.Generator) -> Array:
    """Poses at all places that explain a scan, `(count, 3)` or none."""
    places = distinct_places(map, ends, margin=PLACE_SCORE_MARGIN, most_places=MOST_FRESH_PLACES)
    if not len(places) or places.uncertainty == Uncertainty.TOO_MANY_PLACES:
        return np.zeros((0, 3))
    chosen = np.arange(count) % len(places)
    roots = np.linalg.cholesky(places.covariances)[chosen]
    away = np.einsum("nij,nj->ni", roots, rng.normal(0, 1, (count, 3)))
    return np.asarray(places.poses[chosen] + away)


def kld_sample_size(poses: Array) -> int:
    """How many of the first particles are enough for the cells in which these lie (Fox 2003)."""
    cells = np.floor(poses / KLD_CELL).astype(np.int64)
    new = np.isin(np.arange(len(cells)), np.unique(cells, axis=0, return_index=True)[1])
    a = 2 / (9 * np.maximum(np.cumsum(new) - 1, 1))
    needed = (1 - a + np.sqrt(a) * KLD_QUANTILE) ** 3 / (9 * a * KLD_ERROR)
    enough = np.arange(1, len(cells) + 1) >= np.maximum(needed, LEAST_PARTICLES)
    return int(np.argmax(enough)) + 1 if enough.any() else len(cells)


def at_places(poses: Array, weights: Array) -> list[NDArray[np.int64]]:
    """Which particles are at each place, that of the heaviest first, without dropped places."""
    rest, places = np.arange(len(poses)), []
    while len(rest):
        heaviest = poses[rest[np.argmax(weights[rest])]]
        near = at_one_place(poses[rest], heaviest, SAME_PLACE_M, SAME_PLACE_RAD)
        places.append(rest[near])
        rest = rest[~near]
    return [place for place in places if weights[place].sum() >= MIN_PLACE_WEIGHT]


def redraw(
    poses: Array,
    weights: Array,
    places: list[NDArray[np.int64]],
    most: int,
    rng: np.random.Generator,
) -> tuple[Array, Array]:
    """The particles of each place drawn anew, where few of them hold its weight.

    Chance takes no place away: half of the particles go to the places by their weight, and half to
    all alike.
    """
    shares = np.array([weights[place].sum() for place in places]) ** MEMORY
    shares /= shares.sum()
    chosen, anew = [], []
    for place, share in zip(places, shares, strict=True):
        own = weights[place] / weights[place].sum()
        count = max(int(most * (share + 1 / len(places)) / 2), 1)
        if len(place) > count or effective_number(own) < len(place) / 2:
            place = rng.permutation(place[systematic(own, rng.uniform(), count)])
            place = place[: kld_sample_size(poses[place])]
            own = np.full(len(place), 1 / len(place))
        chosen.append(place)
        anew.append(share * own)
    return poses[np.concatenate(chosen)], np.concatenate(anew)


def estimate(
    poses: Array, weights: Array, places: list[NDArray[np.int64]], fit: float, least: float
) -> Belief:
    """The likeliest place with its covariance; found only where its fit reaches `least`."""
    if not places:
        unknown = np.full(3, np.nan), np.full((3, 3), np.nan)
        words, kind = "lost: no place explains the scan", Uncertainty.NO_PLACE
        return Belief(*unknown, 0.0, 0.0, words, poses, weights, kind)
    shares = np.array([weights[place].sum() for place in places])
    place, share = places[int(np.argmax(shares))], float(shares.max())
    weight = weights[place] / share
    flat = np.column_stack([poses[place, :2], wrap(poses[place, 2] - poses[place[0], 2])])
    mean = weight @ flat
    covariance = np.asarray(((flat - mean).T * weight) @ (flat - mean))
    pose = np.array([mean[0], mean[1], float(wrap(mean[2] + poses[place[0], 2]))])
    kind, reason = Uncertainty.NONE, ""
    poor = f"at the best place the last scans, or their lines, fit to {fit:.2f} only"
    if fit < LOST_FIT:
        kind, reason = Uncertainty.LOST, f"lost: {poor}"
    elif fit < least:
        kind, reason = Uncertainty.POOR_FIT, f"not yet: {poor}"
    elif len(places) > 1:
        kind, reason = Uncertainty.SEVERAL_PLACES, f"not yet: {len(places)} places"
    return Belief(pose, covariance, share, fit, reason, poses, weights, kind)
