"""What is written of an outcome, and the layers that are made of it when they are asked for."""

from __future__ import annotations

import datetime
import math
import tempfile
from pathlib import Path

import numpy as np

from ... import _warm, exports, extraction, reduction
from ..._map_pipeline import Pipeline, cropped, world_of
from ...arrays import Array
from ...files import shown
from ...plan import FloorPlan, floor_plan
from ...poses import transform
from ...quadtree import QuadtreeMap, build_map
from ...scans import Log

#: Sides of the cells of a map for a robot, metres.
CELL = 0.05
#: Points of so many scans are drawn at most.
MOST_DRAWN_SCANS = 400
#: Points of so many scans are drawn while a map grows.
SKETCHED_SCANS = 50
#: Leaves of at most this occupancy are free, as in `exports.write_ros_map`.
FREE_OCCUPANCY = 0.25


def write_outcome(path: str | Path, outcome: Pipeline, which: int = 0) -> None:
    """Write what a method leaves in the format that the end of the name asks for."""
    reduced, end = outcome.reductions[which], Path(path).suffix.lower()
    if end == ".yaml":
        exports.write_ros_map(path, cells(outcome))
    elif end in (".pdf", ".png"):
        title, words = shown(outcome.given.name), outcome.verdict.words
        today = datetime.date.today().isoformat()
        degrees = outcome.recipe.edits.get("north")
        north = None if degrees is None else math.radians(degrees[0])
        exports.write_sheet(path, reduced, title=title, verdict=words, date=today, north=north)
    else:
        exports.write_segments(path, reduced, world=world_of(outcome.recipe.edits))


def written(outcome: Pipeline, name: str) -> dict[str, bytes]:
    """The files that `write_outcome` makes, by their names."""
    with tempfile.TemporaryDirectory() as folder:
        write_outcome(Path(folder) / name, outcome)
        return {path.name: path.read_bytes() for path in sorted(Path(folder).iterdir())}


def cells(outcome: Pipeline) -> QuadtreeMap:
    """The quadtree of an outcome: what is occupied and what is free."""
    tree = build_map(outcome.log_without_passers, outcome.alignment.trusted, resolution=CELL)
    return cropped(tree, outcome.recipe.edits.get("crop"))


def free_space(outcome: Pipeline) -> Array:
    """Squares that beams crossed, `(n, 3)`: lower left corner and side, metres."""
    _warm.dispatch(["quadtree all"])
    tree = cells(outcome)
    x, y, side = tree.leaves()[:3]
    return np.stack([x, y, side], -1)[tree.leaf_occupancy() <= FREE_OCCUPANCY]


def plan_of(outcome: Pipeline) -> FloorPlan:
    """The floor plan of an outcome, as `segmap plan` makes it: of one line a wall."""
    _warm.dispatch(["quadtree all", "reduction one_per_wall"])
    log, poses = outcome.log_without_passers, outcome.alignment.trusted
    seen = extraction.build_map(log, poses, keep_points=True)
    free = build_map(log, poses, resolution=CELL, free_resolution=CELL)
    crop = outcome.recipe.edits.get("crop")
    walls = reduction.one_per_wall(cropped(seen, crop).filtered())
    return floor_plan(walls, cropped(free, crop))


def plan_picture(plan: FloorPlan, outcome: Pipeline) -> bytes:
    """The sheet of a floor plan, as PNG."""
    with tempfile.TemporaryDirectory() as folder:
        path, today = Path(folder) / "plan.png", datetime.date.today().isoformat()
        words = outcome.verdict.words
        exports.write_plan(path, plan, title=outcome.given.name, verdict=words, date=today)
        return path.read_bytes()


def drawn_points(log: Log, poses: Array, *, sketched: bool = False) -> Array:
    """Where beams of scans ended, `(n, 2)`, metres: all that can be drawn, or a sketch of them."""
    known = np.flatnonzero(np.isfinite(poses).all(1))
    scans = known[:: 1 + len(known) // (SKETCHED_SCANS if sketched else MOST_DRAWN_SCANS)]
    found = [transform(poses[k], log[int(k)].points()[:: 1 + sketched]) for k in scans]
    return np.concatenate([np.zeros((0, 2)), *found])
