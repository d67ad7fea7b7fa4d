"""Floor plans."""

from __future__ import annotations

from matplotlib.axes import Axes

from .. import arrays
from ..plan import FloorPlan
from ._segments import draw_segments
from ._style import ERROR, GROUPS, MAP, RAW

#: How much of the colour of a room shows.
TINT = 0.25


def draw_plan(plan: FloorPlan, *, ax: Axes | None = None) -> Axes:
    """Draw a floor plan: rooms tinted, with their areas; doors orange, clutter grey.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from segmap import build_map, load, quadtree
    >>> from segmap.plan import floor_plan
    >>> log = load("room")
    >>> free = quadtree.build_map(log, log.truth, resolution=0.05, free_resolution=0.05)
    >>> plan = floor_plan(build_map(log, log.truth), free)
    >>> ax = draw_plan(plan, ax=Figure().subplots())
    >>> len(ax.texts) == len(plan.rooms)
    True
    """
    arrays.instance(plan, "plan", FloorPlan)
    ax = draw_segments(plan.clutter, ax=ax, color=RAW, width=0.8)
    draw_segments(plan.walls, ax=ax, color=MAP, width=1.2)
    for k, room in enumerate(plan.rooms):
        ax.fill(*room.outline.T, color=GROUPS[k % len(GROUPS)], alpha=TINT, linewidth=0)
        for hole in room.holes:
            ax.fill(*hole.T, color="white", linewidth=0)
        x, y = room.place
        ax.text(x, y, f"{room.area:.1f}", ha="center", va="center", fontsize="small")
    for door in plan.doors:
        ax.plot(*door.ends.T, color=ERROR, linewidth=3, solid_capstyle="butt")
    return ax
