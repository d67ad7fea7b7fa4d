"""The floor plan of a map, as the command and the page draw it."""

from __future__ import annotations

import datetime
import math
from collections.abc import Sequence
from typing import Any

from segmap import __version__, extraction, reduction, warm
from segmap.display import plural
from segmap.files import escape
from segmap.plan import FloorPlan, floor_plan
from segmap.plan.edits import Edit
from segmap.quadtree import build_map

from .pipeline import POLYLINES, Pipeline, cropped

#: Sides of the cells of a map for a robot, and of the free space of a floor plan, metres.
CELL = 0.05


def plan_of(outcome: Pipeline, edits: Sequence[Edit] = ()) -> FloorPlan:
    """The floor plan of an outcome, of one line a wall; edits are in the frame of the log."""
    warm.dispatch(["extraction extract_polylines", "quadtree all", "reduction one_per_wall"])
    log, poses = outcome.log_without_passers, outcome.alignment.trusted
    recipe = outcome.recipe
    if recipe.extract == POLYLINES and recipe.keeps_points():
        seen = outcome.extracted
    else:
        seen = extraction.build_map(log, poses, keep_points=True)
    free = build_map(log, poses, resolution=CELL, free_resolution=CELL)
    crop = recipe.edits.get("crop")
    walls = reduction.one_per_wall(cropped(seen, crop).filtered())
    turned = [edit.turned(outcome.turn) for edit in edits]
    return floor_plan(walls, cropped(free, crop), edits=turned)


def sheet_words(outcome: Pipeline) -> dict[str, Any]:
    """What a sheet says of an outcome: title, verdict, day and source, and where north is."""
    recipe, today = outcome.recipe, datetime.date.today().isoformat()
    source = f"{plural(len(outcome.given), 'scan')}, {recipe.align.name}, segmap {__version__}"
    words = {"title": escape(outcome.given.name), "verdict": outcome.verdict.words, "date": today}
    (degrees,) = recipe.edits.get("north", [None])
    north = None if degrees is None else math.radians(degrees)
    return words | {"source": source, "north": north}
