"""Panels of the chapters on scores and on matchers."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from segmap.angles import wrap
from segmap.arrays import Array
from segmap.extraction import extract_polylines
from segmap.matching import (
    MATCHERS,
    SCORES,
    Belief,
    DistanceField,
    KalmanState,
    Particles,
    localize,
    localize_ekf,
    nearest_score,
    occupancy_score,
    particle_mapping,
    particle_paths,
)
from segmap.plotting import ERROR, RAW, RESULT, TRUTH, draw_quadtree, draw_segments
from segmap.poses import transform
from segmap.quadtree import QuadtreeMap, build_map
from segmap.scans import Log
from segmap.segments import SegmentMap
from segmap.simulation import OdometryNoise

from .._landscapes import Landscape, heading_profile, landscape, peaks
from ..drawings import draw_climb, draw_landscape, draw_profile, label_axes
from ._lesson import LessonPanel, keyword, note, pick, play, slide, tick

#: The two landscapes that chapter 26 compares.
LANDS = {"distance": nearest_score, "occupancy": occupancy_score}


class LandscapePanel(LessonPanel):
    """What a matcher could climb: a score over x and y, and over the heading (B 4.3).

    The scan chosen is laid on the map of those before it, with its heading turned. The log has a
    truth for every scan; the resolution, metres, is that of the map.

    Examples
    --------
    >>> from segmap_course import room_walk
    >>> panel = LandscapePanel(room_walk(40))
    >>> panel.peaks.value
    '1 peak within 30 cm'
    >>> panel.score.value = "occupancy"
    >>> panel.peaks.value
    '101 peaks within 30 cm'
    """

    land: Landscape
    score = pick(LANDS)
    scan = slide(lambda p: len(p.log) // 4, 1, lambda p: len(p.log) - 1, 1, "")
    turn = slide(0, -20, 20, 1, "degrees", label="turned")
    peaks = best = note()
    rows = ("score", "scan", "turn", "peaks best")
    words = "{score}: {peaks}, {best}"
    pixels = {"width": 560}  # noqa: RUF012

    def __init__(self, log: Log, *, resolution: float = 0.01) -> None:
        truth = log.truth
        if truth is None or not np.isfinite(truth).all() or len(log) < 2:
            raise ValueError(f"log {log.name!r} must have two scans or more, each with its truth")
        self.log, self.truth, self.resolution = log, truth, resolution
        self._maps: dict[int, QuadtreeMap] = {}
        self._begin()

    def _draw(self, figure: Figure) -> None:
        k, score = self.scan.value, LANDS[self.score.value]
        if k not in self._maps:
            poses = self.truth[:k]
            self._maps = {k: build_map(self.log[:k], poses, resolution=self.resolution)}
        scan = self._maps[k], self.log[k].points()
        pose = self.truth[k] + (0, 0, self.turn.meant())
        self.land = landscape(*scan, pose, score=score, step=0.015)
        tops = peaks(self.land.values)
        self.peaks.value = f"{len(tops)} peak{'s' * (len(tops) != 1)} within 30 cm"
        y, x = self.land.offsets[tops[0]]
        self.best.value = f"the highest {100 * np.hypot(x, y):.1f} cm off"
        landscape_ax, profile_ax = figure.subplots(1, 2)
        draw_landscape(self.land, ax=landscape_ax)
        turn, values = heading_profile(*scan, self.truth[k], score=score)
        draw_profile(turn, values, ax=profile_ax, tops=False).set_xticks((-180, -90, 0, 90, 180))


class MatcherPanel(LessonPanel):
    """A scan that starts from a wrong pose, and how a matcher moves it (B 4.3).

    A step is an accepted move of hill climbing, or a round of sampling: all poses that were tried
    in it, the best so far last. Beyond the last step it stays there; where that is, is told at any
    step, so that what a threshold does is seen at once. The scan belongs at the pose.
    The landscape is that of the heading after the step: it changes when the scan is turned.

    Examples
    --------
    >>> from segmap_course import room_walk
    >>> from segmap.quadtree import build_map
    >>> log = room_walk(40)
    >>> tree = build_map(log[:10], log.truth[:10], resolution=0.01)
    >>> panel = MatcherPanel(tree, log[10].points(), log.truth[10])
    >>> panel.step.value = 60
    >>> panel.error.value
    '0.2 cm and 0.2 degrees off'
    """

    #: After each step, `(k, 3)`.
    poses: list[Array]
    matcher = pick(MATCHERS)
    score = pick(SCORES)
    x = slide(10, -25, 25, 1, "cm", label="start off in x")
    y = slide(10, -25, 25, 1, "cm", label="start off in y")
    turn = slide(3, -20, 20, 1, "degrees", label="and turned")
    rounds = slide(60, 1, 60, 1, "", label="moves at most")
    shift = slide(2.0, 0.2, 10.0, 0.2, "cm", label="sigma of a shift")
    rotation = slide(2.0, 0.2, 20.0, 0.2, "degrees", label="sigma of a turn")
    step = slide(0, 0, 60, 1, "")
    play = play("step", interval=300)
    count = error = end = note()
    rows = (
        "matcher score",
        "x",
        "y",
        "turn",
        "rounds",
        "shift",
        "rotation",
        "play step",
        "count error end",
    )
    words = "{matcher}, {score}: {count}, {error}"
    pixels = {"width": 400, "height": 380}  # noqa: RUF012

    def __init__(self, map: QuadtreeMap, points: ArrayLike, pose: ArrayLike) -> None:
        self.map, self.points = map, np.asarray(points, float)
        self.pose = np.asarray(pose, float)
        self._lands: dict[tuple[str, float], Landscape] = {}
        self._begin()

    def _draw(self, figure: Figure) -> None:
        start = self.pose + [self.x.meant(), self.y.meant(), self.turn.meant()]
        climbs = self.matcher.value.startswith("hill")
        self.rounds.disabled = not climbs
        self.shift.disabled = self.rotation.disabled = self.matcher.value != "sample and rank"
        self.poses = self._visited(start, climbs)
        k = min(self.step.value, len(self.poses) - 1)
        now = self.poses[k][-1]
        name = "move" if climbs else "round"
        self.count.value = f"{name} {k} of {len(self.poses) - 1}"
        heading = now[2] - self.pose[2]
        self.error.value = self._off(now)
        self.end.value = f"in the end {self._off(self.poses[-1][-1])}"
        seen = self.score.value, round(float(np.degrees(heading)), 1)
        if seen not in self._lands:
            scan = self.map, self.points, self.pose + (0, 0, heading)
            self._lands[seen] = landscape(*scan, score=SCORES[seen[0]], step=0.02)
        ax = draw_landscape(self._lands[seen], ax=figure.subplots(), tops=False)
        ax.set_title(f"Scores of the scan turned by {seen[1]:+.1f} degrees", fontsize="medium")
        way = np.concatenate(self.poses[: k + 1]) if climbs else self.poses[k]
        draw_climb(way - self.pose, ax=ax, joined=climbs)

    def _off(self, pose: Array) -> str:
        x, y, heading = pose - self.pose
        turned = f"{abs(np.degrees(heading)):.1f} degrees"
        return f"{100 * np.hypot(x, y):.1f} cm and {turned} off"

    def _visited(self, start: Array, climbs: bool) -> list[Array]:
        """Poses after 0, 1, 2 ... accepted moves, `(1, 3)` each; or of all rounds of sampling.

        For "field" one distance field serves all calls.
        """
        best, visits = (-np.inf, start), [start[None]]
        score, fast = SCORES[self.score.value], self.score.value == "field"
        field = DistanceField.around(self.map, self.points, start) if fast else None

        def watched(map: QuadtreeMap, points: ArrayLike, poses: ArrayLike) -> Array:
            """Scores, `(n,)`; a pose that beats all before is a move, all asked at once a round."""
            nonlocal best
            values = field.score(points, poses) if field else score(map, points, poses)
            tried = np.asarray(poses, float)
            better = values.max() > best[0]
            if better:
                best = float(values.max()), tried[int(values.argmax())]
            if better or not climbs:
                visits.append(best[1][None] if climbs else np.concatenate([tried, best[1][None]]))
            return values

        rng = np.random.default_rng(0 if climbs else 64)
        options: dict[str, Any] = {"rounds": self.rounds.value} if climbs else {}
        if not self.shift.disabled:
            options = {"sigma": (self.shift.meant(), float(self.rotation.meant()))}
        MATCHERS[self.matcher.value](rng)(self.map, self.points, start, score=watched, **options)
        return visits[1:] if climbs else visits


class ParticlePanel(LessonPanel):
    """Particles that map a log: their ways in grey up to a scan, the best one's in blue, its map.

    Examples
    --------
    >>> from segmap_course import room_walk
    >>> panel = ParticlePanel(room_walk(12))
    >>> panel.scan.value = 11
    >>> panel.error.value
    'the best 2.6 cm off'
    """

    #: What `particle_mapping` has yielded so far.
    steps: list[Particles]
    particles = slide(8, 1, 30, 1, "")
    noise = slide(1.0, 0.0, 3.0, 0.1, "")
    scan = slide(lambda p: len(p.log) // 4, 0, lambda p: len(p.log) - 1, 1, "")
    play = play("scan", interval=200)
    count = error = note()
    rows = ("particles noise", "play scan", "count error")
    words = "{particles} particles, noise {noise}, scan {scan}: {count}, {error}"
    pixels = {"width": 560, "height": 380}  # noqa: RUF012

    def __init__(self, log: Log) -> None:
        if log.truth is None:
            raise ValueError(f"{log.name} must have a true pose for every scan")
        self.log, self.truth = log, log.truth
        self._runs: dict[tuple[int, float], tuple[list[Particles], Iterator[Particles]]] = {}
        self._begin()

    def _draw(self, figure: Figure) -> None:
        chosen, k = (self.particles.value, self.noise.value), self.scan.value
        truth = self.truth
        if chosen not in self._runs:
            rng = np.random.default_rng(1)
            options: Any = {"particles": chosen[0], "noise": chosen[1], "start": truth[0]}
            self._runs[chosen] = [], particle_mapping(self.log, rng=rng, **options)
        self.steps, still = self._runs[chosen]  # only as far as it was asked for
        self.steps.extend(islice(still, max(k + 1 - len(self.steps), 0)))
        step, paths = self.steps[k], particle_paths(self.steps[: k + 1])
        self.count.value = f"{step.effective:.1f} of {chosen[0]} count"
        off = np.hypot(*(step.pose - truth[k])[:2])
        self.error.value = f"the best {100 * off:.1f} cm off"
        ax = figure.subplots()
        map = build_map(self.log[: k + 1], paths[step.best], resolution=0.05)
        draw_quadtree(map, ax=ax, outlines=False)
        for path in paths:
            ax.plot(*path[:, :2].T, color=RAW, linewidth=1)
        ax.plot(*truth[: k + 1, :2].T, color=TRUTH, linewidth=2)
        ax.plot(*paths[step.best, :, :2].T, color=RESULT, linewidth=1.5)
        ax.plot(*step.poses[:, :2].T, ".", color=ERROR)


class PlacePanel(LessonPanel):
    """A robot that looks for its place on a known map while it drives (B 2.2).

    Its particles after each scan are blue, the truth is green, what is believed is orange. Carried
    away, the robot goes from a third of the log at once to its last third. The log has a truth for
    every scan.

    Examples
    --------
    >>> from segmap_course import room_walk
    >>> log = room_walk(40)
    >>> panel = PlacePanel(build_map(log, log.truth, resolution=0.05), log)
    >>> panel.scan.value = 39
    >>> panel.place.value, panel.error.value
    ('found', '0 cm off')
    """

    beliefs: list[Belief]
    scan = slide(lambda p: len(p.log) // 2, 0, lambda p: len(p.log) - 1, 1, "")
    play = play("scan", interval=300)
    carried = tick("carried away", says=("as it drives", "carried away"))
    place = error = note()
    rows = ("play scan", "carried", "place error")
    words = "scan {scan}, {carried}: {place}, {error}"
    pixels = {"width": 480, "height": 420}  # noqa: RUF012

    def __init__(self, map: QuadtreeMap, log: Log) -> None:
        if log.truth is None:
            raise ValueError(f"log {log.name!r} must have the truth of each scan")
        self.map, self.log, self.truth = map, log, log.truth
        self._found: dict[bool, list[Belief]] = {}
        self._begin()

    def _draw(self, figure: Figure) -> None:
        carried, count = self.carried.value, len(self.log)
        gone = range(2 * count // 3, count) if carried else range(count // 3, count)
        order = [*range(count // 3), *gone]
        if carried not in self._found:
            scans = [self.log[k] for k in order]
            self._found[carried] = list(localize(self.map, scans, rng=np.random.default_rng(67)))
        self.beliefs = self._found[carried]
        k = min(self.scan.value, len(order) - 1)
        belief, true = self.beliefs[k], self.truth[order[k]]
        self.place.value = belief.reason or "found"
        off = np.hypot(*(belief.pose - true)[:2])
        turned = abs(np.degrees(wrap(belief.pose[2] - true[2])))
        self.error.value = f"{100 * off:.0f} cm off" + (", turned" if turned > 30 else "")
        ax = draw_quadtree(self.map, ax=figure.subplots(), outlines=False)
        ax.plot(*belief.poses[:, :2].T, ".", color=RESULT, markersize=3)
        for pose, color in ((true, TRUTH), (belief.pose, ERROR)):
            ahead = 0.6 * np.array([np.cos(pose[2]), np.sin(pose[2])])
            ax.plot(*pose[:2], "o", color=color, markersize=6)
            ax.plot(*np.stack([pose[:2], pose[:2] + ahead], -1), color=color, linewidth=2)
        ax.set_title(f"{len(belief.poses)} particles", fontsize="medium")


class KalmanPanel(LessonPanel):
    """An extended Kalman filter on true walls, that starts beside its place.

    Blue are the segments of the scan that a wall explains, orange all others, at the pose believed.
    At the right the error of the place after each scan, and twice the deviation that is claimed.
    The log has odometry, and a truth for every scan.

    Examples
    --------
    >>> from segmap_course import room_walk, room_walls
    >>> from segmap import SegmentMap
    >>> panel = KalmanPanel(SegmentMap(room_walls()), room_walk(12))
    >>> panel.scan.value = 11
    >>> panel.claim.value
    'twice the deviation 0.00 m'
    """

    states: list[KalmanState]
    method = staticmethod(localize_ekf)
    off = slide(0, -60, 60, 5, "cm", label="start off in y")
    gate = keyword(0.5, 0.9999, 0.01)
    scan = slide(0, 0, lambda panel: len(panel.log) - 1, 1, "")
    play = play("scan", interval=200)
    place = claim = note()
    rows = ("off gate", "play scan", "place claim")
    words = "start {off:+d} cm off, scan {scan}: {place}, {claim}"
    pixels = {"width": 640, "height": 300}  # noqa: RUF012

    def __init__(
        self, map: SegmentMap, log: Log, *, odometry_noise: OdometryNoise = OdometryNoise()
    ) -> None:
        if log.truth is None:
            raise ValueError(f"log {log.name!r} must have the truth of each scan")
        self.map, self.log, self.truth, self.noise = map, log, log.truth, odometry_noise
        self._begin()

    def _draw(self, figure: Figure) -> None:
        start, k = self.truth[0] + (0, self.off.meant(), 0), self.scan.value
        spread = np.diag([0.1, max(0.1, abs(self.off.meant())), 0.03]) ** 2
        chosen = self.chosen() | {"odometry_noise": self.noise, "wall_sigma": 0.0}
        self.states = list(localize_ekf(self.map, self.log, start, spread, **chosen))
        away = np.array([s.pose - t for s, t in zip(self.states, self.truth, strict=True)])[:, :2]
        error = np.hypot(*away.T)
        claimed = 2 * np.array([np.sqrt(np.trace(s.covariance[:2, :2])) for s in self.states])
        self.place.value = f"{error[k]:.2f} m off"
        self.claim.value = f"twice the deviation {claimed[k]:.2f} m"
        map_ax, error_ax = figure.subplots(1, 2)
        draw_segments(self.map, ax=map_ax, color=RAW)
        seen = transform(self.states[k].pose, extract_polylines(self.log[k].points()))
        paired = np.isin(np.arange(len(seen)), self.states[k].pairs[:, 0])
        for some, color in ((seen[paired], RESULT), (seen[~paired], ERROR)):
            if len(some):
                draw_segments(some, ax=map_ax, color=color)
        map_ax.plot(*self.truth[k, :2], "o", color=TRUTH)
        map_ax.plot(*self.states[k].pose[:2], "o", color=ERROR, markersize=4)
        error_ax.semilogy(np.maximum(error, 1e-4), color=ERROR, label="off")
        error_ax.semilogy(claimed, color=RESULT, label="twice the deviation")
        error_ax.axvline(k, color=RAW, linewidth=0.8)
        label_axes(error_ax, f"{len(seen[paired])} of {len(seen)} paired", "scan", "m")
