"""A laser that is carried by a hand: what its live map errs by, costs and holds in memory.

`python -m benchmarks.bench_carried errors` prints the table of both emulated lasers, three hands
and three ways in which a speed changes: between scans, as `simulate` has it, with a jump in
mid-scan, and smoothed over a scan. `cpu` times 5 000 scans of each laser and hand, `memory` follows
a drive of thirty minutes. `make bench` takes short ones of each.
"""

import itertools
import sys
import tempfile
import time
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from segmap import warm
from segmap.carried import CASES, CarriedMap
from segmap.extraction import build_map
from segmap.metrics import against_walls
from segmap.poses import between
from segmap.reduction import one_per_wall
from segmap.scans import LaserScan, Log
from segmap.scans.motion import motion_compensated
from segmap.sensors import SpinningLaser
from segmap.sensors.emulator._spinning import SpinningUnit
from segmap.simulation import office
from segmap_app.drives import save_each

from .measure import Row


class Laser(NamedTuple):
    """A model, its beams a turn, seconds a turn, and its errors: metres, and share of the range."""

    model: str
    beams: int
    period: float
    sigma: float
    share: float


class Hand(NamedTuple):
    """Metres and degrees in each scan of a hand that walks and turns; it also stands at times.

    One that `stops` does so before it turns again.
    """

    name: str
    way: float
    turn: float
    stops: bool = False


LASERS = (Laser("LD19", 450, 0.1, 0.01, 0.0), Laser("RPLIDAR-A1", 360, 0.18, 0.005, 0.006))
HANDS = (
    Hand("calm", 0.05, 8.0),
    Hand("fast", 0.10, 25.0),
    Hand("stops, 40 deg", 0.10, 40.0, stops=True),
)
#: How a speed changes, and in how many scans it does so on average.
CHANGES, SCANS_A_CHANGE = ("between", "jumps", "smoothed"), 8
#: Through a simulated office and its six rooms, and the reach of the laser, metres.
WALLS, REACH = office(rng=np.random.default_rng(1)), 12.0
CORNERS = [(1, 5), *((x, y) for x in (2, 6, 10) for y in (5, 6.9, 5, 3.1, 5)), (11, 5)]
ROUTE = np.array([*CORNERS, *CORNERS[-2:0:-1], CORNERS[0]], float)
ENDS = np.r_[0.0, np.cumsum(np.hypot(*np.diff(ROUTE, axis=0).T))]
#: A long drive goes round and round, minutes a round.
TRIP_MINUTES = 2
#: Minutes at which the memory is read.
MINUTES = (1, 5, 10, 20, 30)


def speeds(hand: Hand, laser: Laser, change: str, rng: np.random.Generator) -> Iterator[Any]:
    """Metres and radians from beam to beam, `(beams, 2)`, of scan after scan."""
    moves, beams, rest, before = True, laser.beams, np.zeros((0, 2)), np.zeros((laser.beams, 2))
    while True:
        while len(rest) < beams:
            length = int(rng.integers(3, 2 * SCANS_A_CHANGE - 2)) * beams
            length += int(rng.integers(beams)) * (change != "between")
            way = hand.way * (rng.random() > 0.2)
            turn = np.radians(hand.turn) * rng.choice([-1, 1]) * (rng.random() > 0.2)
            if hand.stops and moves:
                way = turn = 0.0
            moves = not moves
            rest = np.vstack([rest, np.tile([way / beams, turn / beams], (length, 1))])
        now, rest = rest[:beams], rest[beams:]
        if change == "smoothed":  # each speed is the mean over the last turn
            both = np.cumsum(np.vstack([before, now]), axis=0)
            before, now = now, (both[beams:] - both[:-beams]) / beams
        yield now


def motion(speeds: Iterable[Any]) -> Iterator[Any]:
    """Poses `(beams, 3)` of the laser in each scan of a drive to and fro through the office."""
    along, heading = 0.0, 0.0
    for now in speeds:
        way, turned = along + np.cumsum(now[:, 0]), heading + np.cumsum(now[:, 1])
        x, y = (np.interp(way % ENDS[-1], ENDS, ROUTE[:, k]) for k in (0, 1))
        yield np.stack([x, y, turned], -1)
        along, heading = way[-1], turned[-1]


def cast(poses: Any, aims: Any) -> Any:
    """Ranges of beams, each from its own pose, to the nearest wall; infinite beyond the reach."""
    ways = np.stack([np.cos(aims + poses[:, 2]), np.sin(aims + poses[:, 2])], -1)[:, None]
    wall, apart = WALLS[:, 1] - WALLS[:, 0], WALLS[:, 0] - poses[:, None, :2]
    turn = ways[..., 0] * wall[:, 1] - ways[..., 1] * wall[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        ahead = (apart[..., 0] * wall[:, 1] - apart[..., 1] * wall[:, 0]) / turn
        on_wall = (apart[..., 0] * ways[..., 1] - apart[..., 1] * ways[..., 0]) / turn
    met = (ahead > 0) & (on_wall >= 0) & (on_wall <= 1)
    ranges = np.where(met, ahead, np.inf).min(1)
    return np.where(ranges < REACH, ranges, np.inf)


def scans(motion: Iterable[Any], laser: Laser, seed: int) -> Iterator[tuple[LaserScan, Any]]:
    """Turns of the laser as its driver hands them over, clockwise, and the poses of their beams."""
    rng, count = np.random.default_rng(seed), laser.beams
    aims = -2 * np.pi * np.arange(count) / count
    angles, delays = np.angle(np.exp(1j * aims)), laser.period * np.arange(count) / count
    order = np.argsort(angles)
    for k, poses in enumerate(motion):
        true = cast(poses, aims)
        noise = rng.normal(0, 1, count) * (laser.sigma + laser.share * np.minimum(true, REACH))
        ranges = np.where(np.isfinite(true), np.round(true + noise, 3), np.nan)
        beams = ranges[order], angles[order], k * laser.period
        yield LaserScan(*beams, delays=delays[order]), poses[order]


def driven(hand: Hand, laser: Laser, change: str, seed: int) -> Iterator[tuple[LaserScan, Any]]:
    """The scans of a hand, without end."""
    rng = np.random.default_rng(seed)
    return scans(motion(speeds(hand, laser, change, rng)), laser, seed)


def round_trip(hand: Hand, laser: Laser, count: int) -> list[LaserScan]:
    """So many scans, after which the hand is where it was at the first, and holds the laser so."""
    rng = np.random.default_rng(0)
    way = np.array([*itertools.islice(speeds(hand, laser, "jumps", rng), count)])
    way[..., 0] *= ENDS[-1] / way[..., 0].sum()
    way[..., 1] -= way[..., 1].mean()
    return [scan for scan, _ in scans(motion(way), laser, 0)]


class Wire:
    """A port in this thread: reading moves the clock of the laser behind it."""

    baudrate, timeout = 0, 0.0

    def __init__(self, turns: list[LaserScan], model: Any) -> None:
        self.now, self._ready = 0.0, b""
        self._unit = SpinningUnit(turns, model, clock=lambda: self.now)

    @property
    def in_waiting(self) -> int:
        self._ready += self._unit.transmit()
        return len(self._ready)

    def read(self, size: int = 1, /) -> bytes:
        self.now += 0.002
        data, self._ready = self._ready[:size], self._ready[size:]
        return data

    def write(self, data: bytes, /) -> int:
        self._unit.receive(data)
        return len(data)

    def close(self) -> None:
        pass


def errors(laser: Laser, hand: Hand, change: str, count: int, seed: int = 0) -> str:
    """Of scans that came as bytes: poses, lines a wall and invented metres, also of true motion."""
    drive = list(itertools.islice(driven(hand, laser, change, seed), count))
    wire = Wire([scan for scan, _ in drive], laser.model)
    live, carried, slower, lost = CarriedMap(), list[LaserScan](), 0, 0
    with SpinningLaser(laser.model, wire, clock=lambda: wire.now) as sensor:
        for scan in itertools.islice(sensor.scans(), count - 1):
            lost += not live.add(scan).found
            slower += live.advice.startswith("SLOWER")
            last = range(max(len(live.graph) - 2, 0), len(live.graph))  # a first one changes late
            carried[last.start :] = [live.graph.tracked(k).scan for k in last]
    live.finish()
    middles = [poses[np.argsort(scan.delays)[laser.beams // 2]] for scan, poses in drive]
    truth = np.array(middles[: count - 1])
    own = on_top(live.poses, truth)
    true = [
        motion_compensated(scan, between(pose, poses))
        for (scan, poses), pose in zip(drive, truth, strict=False)
    ]
    seen = build_map(Log("true", true), truth, keep_points=True)
    mine = build_map(Log("live", carried), own, keep_points=True)
    off = np.hypot(*(own - truth)[:, :2].T)
    drawn, best = (against_walls(WALLS, one_per_wall(map), seen=seen) for map in (mine, seen))
    words = f"{1000 * np.median(off):4.0f} {1000 * off.max():5.0f} mm off"
    for name, judged in (("", drawn), ("; by its true motion", best)):
        share = 100 * judged.invented / judged.seen.sum()
        words += f"{name} {judged.per_wall:.2f} lines a wall, {share:.1f} % invented"
    return words + f"; lost {lost}, SLOWER {slower} of {count - 1}"


def on_top(poses: Any, truth: Any) -> Any:
    """Poses `(k, 3)` moved as one, to where they lie nearest to the truth."""
    a, b = (rows[:, 0] + 1j * rows[:, 1] for rows in (poses, truth))
    turn = np.vdot(a - a.mean(), b - b.mean())
    turn /= abs(turn)
    xy = b.mean() + turn * (a - a.mean())
    return np.stack([xy.real, xy.imag, poses[:, 2] + np.angle(turn)], -1)


def cpu(laser: Laser, hand: Hand, count: int) -> str:
    """Milliseconds of the processor that a scan takes, after those of the first few."""
    live, took = CarriedMap(), []
    begun, other = time.process_time(), 0.0
    for scan, _ in itertools.islice(driven(hand, laser, "jumps", 0), count):
        other += time.process_time() - begun
        start, begun = time.thread_time(), time.process_time()
        live.add(scan)
        took.append(1000 * (time.thread_time() - start))
    middle, high, most = np.percentile(took[5:], [50, 99, 100])
    late = np.percentile(took[-count // 5 :], 99)
    return (
        f"p50 {middle:.1f}, p99 {high:.1f}, largest {most:.0f} ms; of the last fifth p99 "
        f"{late:.1f} ms; {len(live.graph.front_end.frames)} key frames"
    )


def memory(minutes: float) -> Iterator[Row]:
    """What the process holds in a drive that is written down and mapped."""
    laser, live = LASERS[0], CarriedMap()
    some = round_trip(HANDS[0], laser, round(60 * TRIP_MINUTES / laser.period))
    turns = (replace(scan, time=k * laser.period) for k, scan in enumerate(itertools.cycle(some)))
    marks = {round(60 * at / laser.period): at for at in MINUTES if at <= minutes}
    with tempfile.TemporaryDirectory() as folder:
        for k, scan in enumerate(save_each(turns, Path(folder) / "drive.csv"), 1):
            live.add(scan)
            if k in marks:
                pages = int(Path("/proc/self/statm").read_text().split()[1])
                figure = f"{pages * 4096 / 1e6:.0f} MB; {live!r}, {len(live.map.leaves().x)} leaves"
                yield Row(f"memory after {marks[k]} minutes", figure, "flat but for key frames")
            if k >= max(marks, default=0):
                break


def rows(command: str = "", count: int = 0) -> Iterator[Row]:
    warm.dispatch(CASES)
    for laser, hand in itertools.product(LASERS, HANDS) if command in ("", "errors") else ():
        for change in CHANGES if command else CHANGES[1:2]:
            what = f"{laser.model}, {hand.name}, {change}"
            yield Row(what, errors(laser, hand, change, count or 400), "1.2; 6 %")
    for laser, hand in itertools.product(LASERS, HANDS[:2]) if command in ("", "cpu") else ():
        figure = cpu(laser, hand, count or (5000 if command else 300))
        yield Row(f"{laser.model}, {hand.name}, a scan", figure, "p99 <= 15 ms")
    if command in ("", "memory"):
        yield from memory(count or (30 if command else 1))


if __name__ == "__main__":
    for row in rows(*sys.argv[1:2], *map(int, sys.argv[2:3])):
        print(row.what, row.figure, row.target, sep="\n  ", flush=True)
