"""A wardrobe on its way round the corner of two corridors, and what is left beside it."""

from __future__ import annotations

import numpy as np
import traitlets
from matplotlib.axes import Axes

from segmap.arrays import Positive, checked

from .._clinic import WARDROBE_DEPTH_M, WARDROBE_LENGTH_M, clearance, clearance_at
from ..drawings import draw_corner
from ._drag_figure import DragFigure, module_text


class DragWardrobe(DragFigure):
    """The wardrobe between two corridors of these widths, metres.

    Its ends slide along the outer walls: `turn`, in radians, is 0 along the first corridor. The
    inner corner is dragged too, which changes both widths.

    Examples
    --------
    >>> figure = DragWardrobe(1.2, 1.3)
    >>> figure
    DragWardrobe(corridors of 1.20 and 1.30 m: the least is 16.7 cm at 43 degrees)
    >>> figure.widths = [1.2, 0.9]
    >>> round(figure.least, 3)
    -0.124
    """

    module = "wardrobe_round_the_corner"
    _esm = module_text(module)
    widths = traitlets.List(traitlets.Float()).tag(sync=True)
    #: Length and depth, metres.
    size = traitlets.List(traitlets.Float()).tag(sync=True)
    turn = traitlets.Float().tag(sync=True)

    @checked
    def __init__(self, first: Positive, second: Positive, *, turn: float = 0.35) -> None:
        size = [WARDROBE_LENGTH_M, WARDROBE_DEPTH_M]
        super().__init__(widths=[float(first), float(second)], size=size, turn=float(turn))

    @property
    def here(self) -> float:
        """What is left beside the inner corner at this turn, metres."""
        first, second = self.widths
        return float(clearance_at(first, second, self.turn))

    @property
    def least(self) -> float:
        """What is left at the tightest turn, metres; below 0 it does not go round."""
        return float(clearance(*self.widths)[0])

    @property
    def tightest(self) -> float:
        """The turn at which least is left, radians."""
        return float(clearance(*self.widths)[1])

    def __repr__(self) -> str:
        first, second = self.widths
        return (
            f"DragWardrobe(corridors of {first:.2f} and {second:.2f} m: the least is "
            f"{100 * self.least:.1f} cm at {np.degrees(self.tightest):.0f} degrees)"
        )

    def draw(self, ax: Axes) -> None:
        """Draw both corridors and the wardrobe; orange is what is left."""
        first, second = self.widths
        draw_corner(first, second, self.turn, ax=ax)
        ax.set_title(repr(self)[len("DragWardrobe(") : -1], fontsize="medium")
