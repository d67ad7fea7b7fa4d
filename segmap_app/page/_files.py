"""What is written of an outcome, and the layers that are made of it when they are asked for."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

from segmap import exports, warm
from segmap.arrays import Array
from segmap.plan import FloorPlan
from segmap.poses import transform
from segmap.quadtree import QuadtreeMap, build_map
from segmap.scans import Log

from .. import files
from ..drives import Driving
from ..pipeline import Pipeline, Placing, cropped, world_of
from ..plans import CELL, sheet_words

#: Points of so many scans are drawn at most.
MOST_DRAWN_SCANS = 400
#: Points of so many scans are drawn while a map grows.
SKETCHED_SCANS = 50
#: Places of a drive that goes on.
MOST_DRAWN_PLACES = 2000
#: Leaves of at most this occupancy are free, as in `files.write_ros_map`.
FREE_OCCUPANCY = 0.25


def write_outcome(path: str | Path, outcome: Pipeline, plan: FloorPlan | None = None) -> None:
    """Write what the first method leaves, or the floor plan, as the name asks for."""
    end, edits = Path(path).suffix.lower(), outcome.recipe.edits
    if end == ".yaml":
        files.write_ros_map(path, cells(outcome))
    elif plan is not None:
        exports.write_plan(path, plan, world=world_of(edits), **sheet_words(outcome))
    elif end in (".pdf", ".png"):
        exports.write_sheet(path, outcome.reductions[0], **sheet_words(outcome))
    else:
        exports.write_segments(path, outcome.reductions[0], world=world_of(edits))


def written(name: str, write: Callable[..., object], *contents: object) -> dict[str, bytes]:
    """The files that `write(path, *contents)` makes at this name, by their names."""
    with tempfile.TemporaryDirectory() as folder:
        write(Path(folder) / name, *contents)
        return {path.name: path.read_bytes() for path in sorted(Path(folder).iterdir())}


def cells(outcome: Pipeline) -> QuadtreeMap:
    """The quadtree of an outcome: what is occupied and what is free."""
    tree = build_map(outcome.log_without_passers, outcome.alignment.trusted, resolution=CELL)
    return cropped(tree, outcome.recipe.edits.get("crop"))


def free_space(outcome: Pipeline) -> Array:
    """Squares that beams crossed, `(n, 3)`: lower left corner and side, metres."""
    warm.dispatch(["quadtree all"])
    tree = cells(outcome)
    x, y, side = tree.leaves()[:3]
    return np.stack([x, y, side], -1)[tree.leaf_occupancy() <= FREE_OCCUPANCY]


def drawn_points(log: Log, poses: Array, *, sketched: bool = False) -> Array:
    """Where beams of scans ended, `(n, 2)`, metres: all that can be drawn, or a sketch of them."""
    placed = np.flatnonzero(np.isfinite(poses).all(1))
    scans = placed[:: 1 + len(placed) // (SKETCHED_SCANS if sketched else MOST_DRAWN_SCANS)]
    clouds = [transform(poses[k], log[int(k)].points()[:: 1 + sketched]) for k in scans]
    return np.concatenate([np.zeros((0, 2)), *clouds])


def sketch(words: Placing | Driving) -> tuple[Array, Array, Array, str, str]:
    """What `Canvas.grow` shows of work that goes on, and what to do with the laser."""
    walls = np.zeros((0, 2, 2))
    if isinstance(words, Placing):
        poses = words.graph.poses
        points = drawn_points(words.log, poses, sketched=True)
        return poses[:, :2], points, walls, str(words), ""
    scan = words.map.graph.tracked(len(words.map.graph) - 1).scan
    if (reduced := words.map.walls) is not None:
        walls = reduced.segments
    way = words.map.poses[:, :2]
    way = np.vstack([way[:: 1 + len(way) // MOST_DRAWN_PLACES], words.pose[:2]])
    return way, transform(words.pose, scan.points()), walls, str(words), words.advice
