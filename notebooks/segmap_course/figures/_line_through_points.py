"""Points that are dragged, and two lines through them: by distances, and by vertical distances."""

from __future__ import annotations

import numpy as np
import traitlets
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from segmap import arrays
from segmap.angles import axial_difference
from segmap.arrays import Array
from segmap.extraction import fit_line
from segmap.plotting import ERROR, MAP, RESULT, map_axes

from ._drag_figure import DragFigure, module_text

#: Of a view, around the circle in which the points turn, metres.
_MARGIN_M = 0.1


class DragLine(DragFigure):
    """Points `(n, 2)`, metres, and the lines nearest to them across and along y.

    Examples
    --------
    >>> figure = DragLine([(0, 0), (1, 0.1), (2, -0.1), (3, 0)])
    >>> figure
    DragLine(-1.1 degrees by distances to the line, -1.1 degrees by vertical distances)
    >>> figure.turn(np.radians(91.1))
    >>> figure
    DragLine(90.0 degrees by distances to the line, 13.6 degrees by vertical distances)
    """

    module = "line_through_points"
    _esm = module_text(module)
    points = traitlets.List(traitlets.List(traitlets.Float())).tag(sync=True)
    #: Left, low, right and top of what is seen, metres.
    view = traitlets.List(traitlets.Float()).tag(sync=True)

    def __init__(self, points: ArrayLike) -> None:
        array = arrays.points(points, "points")
        middle = array.mean(axis=0)
        reach = np.hypot(*(array - middle).T).max() + _MARGIN_M
        view = np.concatenate([middle - reach, middle + reach])
        super().__init__(points=array.round(4).tolist(), view=view.round(2).tolist())

    def centre(self) -> Array:
        """The mean of the points, on both lines, metres."""
        return np.mean(self.points, axis=0)

    def angles(self) -> dict[str, float]:
        """The direction of each line, radians, at most a quarter of a turn."""
        off = np.array(self.points) - self.centre()
        (xx, xy), _ = off.T @ off
        total = float(axial_difference(fit_line(self.points)[1], 0.0))
        return {"total": total, "vertical": float(np.arctan2(xy, xx))}

    def turn(self, angle: float) -> None:
        """Turn all points about their mean, radians."""
        c, s = np.cos(angle), np.sin(angle)
        off = (np.array(self.points) - self.centre()) @ np.array([(c, s), (-s, c)])
        self.points = (self.centre() + off).tolist()

    def __repr__(self) -> str:
        total, vertical = (np.degrees(value) + 0.0 for value in self.angles().values())
        across = f"{total:.1f} degrees by distances to the line"
        return f"DragLine({across}, {vertical:.1f} degrees by vertical distances)"

    def draw(self, ax: Axes) -> None:
        """Draw the points, and both lines through their mean."""
        names, colors = ("by distances to the line", "by vertical distances"), (RESULT, ERROR)
        x, y = self.centre()
        for k, angle in enumerate(self.angles().values()):
            to = x + np.cos(angle), y + np.sin(angle)
            ax.axline((x, y), to, color=colors[k], label=names[k], linewidth=(5, 2)[k])
        ax.plot(*np.transpose(self.points), "o", color=MAP, markerfacecolor="white", markersize=8)
        x_min, y_min, x_max, y_max = self.view
        map_axes(ax).set(xlim=(x_min, x_max), ylim=(y_min, y_max))
        ax.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=2, frameon=False)
