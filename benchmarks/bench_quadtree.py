"""Scans inserted into the quadtree, a second, and its bytes, beside yardsticks of the same run."""

import importlib
from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from segmap_course import literal

from segmap import load
from segmap.plotting import draw_quadtree
from segmap.quadtree import QuadtreeMap, build_map

from .measure import Row, missing, once, seconds, workloads

#: Speeds over the literal map: that walks cell by cell, and a tree in plain lists that walked leaf
#: by leaf, as ours, was 19 and 7 times as fast as it.
CASES = {
    "room_urg": ("room, 682 beams, 1 cm", ">= 4 000 (stretch 6 000)", ">= 230 x", "<= 140 kB"),
    "loop_sick8": ("loop, 181 beams, 5 cm", ">= 15 000 (stretch 25 000)", ">= 70 x", "<= 208 kB"),
}
#: Scans that the literal map takes.
FEW = 8
ROUNDS = 5


def rows() -> Iterator[Row]:
    made = workloads()
    if made is None:
        yield from missing("quadtree")
        return
    for name, (words, speed, ratio, size) in CASES.items():
        case = made.occupancy_case(name)
        scans = [
            (pose[:2], made.end_points(ranges, case.sensor.angles, pose))
            for pose, ranges in zip(case.poses, case.ranges, strict=True)
        ]
        ours, slow, dense = measured(case, scans)
        map = ours.map
        yield Row(f"QuadtreeMap, {words}", f"{ours.speed:.0f} scans/s", speed)
        yield Row(f"  literal, {FEW} scans", against(ours, slow), ratio)
        yield Row("  dense numpy grid", against(ours, dense))
        yield Row("  bytes", f"{map.nbytes} = {map.nbytes / len(map.leaves().x):.2f} a leaf", size)
        yield Row("  bytes of the dense grid", f"{dense.map.nbytes}")
        yield octomap(case, scans, ours)
    yield drawing()


def drawing() -> Row:
    """A real map with outlines and its axes, made and rendered."""
    log = load("malaga")
    map = build_map(log, log.truth, resolution=0.1, free_resolution=0.8)

    def drawn() -> None:
        canvas = FigureCanvasAgg(Figure((6, 5), dpi=72))
        draw_quadtree(map, ax=canvas.figure.subplots())
        canvas.draw()

    count, took = len(map.leaves().x), seconds(drawn, 9)
    return Row(f"Malaga drawn, {count} leaves", f"{1e3 * took:.0f} ms", "< 100 ms for 20 000")


class Run:
    """A map, and how fast scans go in: the best of a few rounds, each from an empty map."""

    def __init__(self, make, insert, scans) -> None:
        self.make, self.insert, self.scans = make, insert, scans
        self.times, self.map = [], None

    def round(self) -> None:
        self.map = self.make()
        insert = getattr(self.map, self.insert)
        self.times.append(once(lambda: [insert(*scan) for scan in self.scans]) / len(self.scans))

    @property
    def speed(self) -> float:
        return 1 / min(self.times)


def measured(case, scans) -> tuple[Run, Run, Run]:
    """The three maps in turns, so that a slow minute slows them all; they must agree."""
    few = [(sensor.tolist(), points.tolist()) for sensor, points in scans[:FEW]]
    ours = Run(lambda: QuadtreeMap(resolution=case.cell), "insert_scan", scans)
    slow = Run(lambda: literal.Quadtree(case.cell), "insert", few)
    dense = Run(lambda: DenseGrid(case.bounds, case.cell), "insert", scans)
    ours.make().insert_scan(*scans[0])  # compiles
    for _ in range(ROUNDS):
        for run in (ours, slow, dense):
            run.round()
    check = QuadtreeMap(resolution=case.cell)
    for scan in scans[:FEW]:
        check.insert_scan(*scan)
    counts = zip(*(count.tolist() for count in check.leaves()[3:]), strict=True)
    assert sorted(slow.map.leaves.values()) == sorted(counts)
    assert dense.map.occ.sum() == ours.map.leaves().occ.sum()
    return ours, slow, dense


def against(ours: Run, other: Run) -> str:
    return f"{other.speed:.0f} scans/s: {ours.speed / other.speed:.1f} x as fast"


def octomap(case, scans, ours: Run) -> Row:
    """OctoMap through its Python binding, where that is installed."""
    try:
        library: Any = importlib.import_module("octomap")
    except ImportError:
        return Row("  OctoMap", "skipped", "pip install octomap-python to compare")
    tree = library.OcTree(case.cell)
    flat = [
        (np.append(sensor, 0.0), np.column_stack([points, np.zeros(len(points))]))
        for sensor, points in scans[:10]
    ]
    took = once(lambda: [tree.insertPointCloud(points, sensor) for sensor, points in flat])
    speed = len(flat) / took
    bytes_used = tree.memoryUsage()
    return Row(
        "  OctoMap, 10 scans", f"{speed:.0f} scans/s: {ours.speed / speed:.0f} x; {bytes_used} B"
    )


class DenseGrid:
    """Two counters of four bytes a cell; all rays of a scan at once in numpy."""

    def __init__(self, bounds, cell):
        self.corner, self.cell = np.array(bounds[:2]), cell
        rows, columns = np.ceil((np.array(bounds[2:]) - self.corner) / cell).astype(int)[::-1]
        self.strides = np.array([1, columns])
        self.vis, self.occ = np.zeros(rows * columns, np.int32), np.zeros(rows * columns, np.int32)

    @property
    def nbytes(self):
        return self.vis.nbytes + self.occ.nbytes

    def insert(self, sensor, points):
        start = ((sensor - self.corner) / self.cell).astype(np.int64)
        away = ((points - self.corner) / self.cell).astype(np.int64) - start
        first = start @ self.strides
        np.add.at(self.occ, first + away @ self.strides, 1)
        np.add.at(self.vis, first + away @ self.strides, 1)
        steep = abs(away[:, 1]) > abs(away[:, 0])
        long, short = np.where(steep, away.T[::-1], away.T)
        ahead, aside = (np.sign(v) * np.where(steep ^ i, *self.strides[::-1]) for i, v in
                        enumerate((long, short)))  # fmt: skip
        steps = np.maximum(abs(long) - 1, 0)
        k = np.arange(steps.sum(), dtype=np.int32)
        k -= np.repeat((np.cumsum(steps) - steps).astype(np.int32), steps)
        slope = (abs(short) / np.maximum(abs(long), 1)).astype(np.float32)
        across = (np.repeat(slope, steps) * k + np.float32(0.5)).astype(np.int32)
        cell = k * np.repeat(ahead.astype(np.int32), steps)
        cell += across * np.repeat(aside.astype(np.int32), steps)
        self.vis += np.bincount(cell + first, minlength=len(self.vis)).astype(np.int32)
