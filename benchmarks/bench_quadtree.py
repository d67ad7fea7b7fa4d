"""Scans inserted into the quadtree, a second, and its bytes, beside yardsticks of the same run."""

import importlib
import statistics
from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from segmap import load
from segmap.plotting import draw_quadtree
from segmap.quadtree import QuadtreeMap, build_map

from .measure import Row, missing, once, seconds, workloads
from .plain_quadtree import DenseGrid, PlainTree

CASES = {
    "room_urg": ("room, 682 beams, 1 cm", ">= 4 000 (stretch 6 000)", ">= 12 x", "<= 140 kB"),
    "loop_sick8": ("loop, 181 beams, 5 cm", ">= 15 000 (stretch 25 000)", ">= 10 x", "<= 208 kB"),
}
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
        ours, twin, dense = measured(case, scans)
        map = ours.map
        yield Row(f"QuadtreeMap, {words}", f"{ours.speed:.0f} scans/s", speed)
        yield Row("  plain Python twin", against(ours, twin), ratio)
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
    """A map, and how fast scans go in: the median of a few rounds, each from an empty map."""

    def __init__(self, make, insert) -> None:
        self.make, self.insert, self.times, self.map = make, insert, [], None

    def round(self, scans) -> None:
        self.map = self.make()
        insert = getattr(self.map, self.insert)
        self.times.append(once(lambda: [insert(*scan) for scan in scans]) / len(scans))

    @property
    def speed(self) -> float:
        return 1 / statistics.median(self.times)


def measured(case, scans) -> tuple[Run, Run, Run]:
    """The three maps in turns, so that a slow minute slows them all; they must agree."""
    level = {"room_urg": 11, "loop_sick8": 12}[case.name]
    runs = (
        Run(lambda: QuadtreeMap(resolution=case.cell), "insert_scan"),
        Run(lambda: PlainTree(case.cell, level), "insert"),
        Run(lambda: DenseGrid(case.bounds, case.cell), "insert"),
    )
    runs[0].round(scans)  # compiles
    for _ in range(ROUNDS):
        for run in runs:
            run.round(scans)
    found = runs[0].map.leaves()
    twin = sorted(pair for pair in zip(runs[1].map.vis, runs[1].map.occ, strict=True) if pair[1])
    hit = found.occ > 0
    assert twin == sorted(zip(found.vis[hit].tolist(), found.occ[hit].tolist(), strict=True))
    assert runs[2].map.occ.sum() == found.occ.sum()
    return runs


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
