"""Drawings of the story: what a map says about the clinic."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from segmap.arrays import Segments
from segmap.plotting import ERROR, MAP, RESULT, axes_row, draw_segments, map_axes
from segmap.poses import transform
from segmap.simulation import box, polyline

from .._clinic import (
    WARDROBE_DEPTH_M,
    WARDROBE_LENGTH_M,
    Answers,
    clearance_at,
    measure_clinic,
)

#: So much of both corridors is drawn, metres.
FAR_M = 2.4


def wardrobe(map: Segments, poses: ArrayLike | None = None) -> Answers:
    """Ask a map of the clinic the three questions of the story, and draw the answers.

    Does the wardrobe go round the corner, how thick is the wall between rooms 2 and 3, how long is
    the building? Orange are the tapes that `measure_clinic` stretches; beside the map stands the
    wardrobe at the tightest place between corridors as wide as they are on the map.

    Parameters
    ----------
    map
        SegmentMap, Reduction or `(n, 2, 2)` array, metres.
    poses : (250, 3) array, metres and radians, or None
        Of the scans of `clinic` in the frame of the map: the true ones where none are given.

    Examples
    --------
    >>> from segmap_course import clinic_walls
    >>> wardrobe(clinic_walls())
    wardrobe goes round: 16.7 ± 0.1 cm to spare; wall 10.0 ± 0.1 cm; building 9.00 ± 0.00 m
    """
    answers = measure_clinic(map, poses)
    map_ax, corner_ax = axes_row(2, (8.6, 4.2))
    draw_segments(map, ax=map_ax, color=MAP, width=0.8)
    for ends in answers.ends.values():
        map_ax.plot(*ends.T, "|-", color=ERROR, markersize=5)
    map_ax.set_title(
        f"Wall of rooms 2 and 3: {answers.of_wall}\nBuilding: {answers.of_building}",
        fontsize="medium",
    )
    first, second = (answers.tapes[f"{name} corridor"].metres for name in ("left", "upper"))
    if np.isfinite([first, second]).all():
        draw_corner(first, second, answers.turn, ax=corner_ax)
    else:
        corner_ax.text(0, 0, "a wall was not seen")
    corner_ax.set_title(f"Wardrobe {answers.of_wardrobe}", fontsize="medium")
    map_axes(map_ax)
    map_axes(corner_ax)
    return answers


def draw_corner(first: float, second: float, turn: float, *, ax: Axes | None = None) -> Axes:
    """Draw the corner between corridors of two widths, metres, and the wardrobe at a turn, radians.

    Orange is what is left between the wardrobe and the inner corner.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> ax = draw_corner(1.2, 1.3, 0.75, ax=Figure().subplots())
    """
    outer, inner = [(0, -FAR_M), (0, 0), (FAR_M, 0)], [(first, -FAR_M), (first, -second)]
    walls = [polyline(outer), polyline([*inner, (FAR_M, -second)])]
    ax = draw_segments(np.concatenate(walls), ax=ax, color=MAP, width=1.5)
    heading = np.pi / 2 - turn  # of the long side, from the left wall to the upper one
    start = (0, -WARDROBE_LENGTH_M * np.cos(turn), heading)
    middle = transform(start, np.array([WARDROBE_LENGTH_M, -WARDROBE_DEPTH_M]) / 2)
    wardrobe = box(WARDROBE_LENGTH_M, WARDROBE_DEPTH_M, (*middle, heading))
    ax.fill(*wardrobe[:, 0].T, color=RESULT, alpha=0.3)
    across = np.array([np.cos(turn), -np.sin(turn)]) * clearance_at(first, second, turn)
    ax.plot(*np.array([(first, -second), (first, -second) - across]).T, color=ERROR, linewidth=3)
    return map_axes(ax)
