"""One building as segments and as squares, and what each takes."""

import ipywidgets as W
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from .. import arrays
from ..arrays import Segments
from ..experiments import Judged, judge, keep
from ..panels import Panel, slider, text
from ..plotting import RESULT, TRUTH, draw_quadtree, draw_segments
from ..scans import Log


class StoragePanel(Panel):
    """An aligned log kept as reduced segments and as a quadtree (A and B of one building).

    Parameters
    ----------
    log : Log
    poses : (k, 3) array, metres and radians
    walls : (n, 2, 2) array, metres
        The truth.

    Attributes
    ----------
    resolution : slider, centimetres
    tolerance : slider, centimetres
        Of the reduction by Fusion.
    tree : box to tick
        Which of the two is drawn, under the true walls in green.
    segments, squares : labels
    judged : dict of str -> Judged

    Examples
    --------
    >>> from segmap.course import room_walk, room_walls
    >>> log = room_walk(20)
    >>> StoragePanel(log, log.truth, room_walls()).segments.value
    '12 segments, 0.4 kB, 0.8 mm off'
    """

    judged: dict[str, Judged]

    def __init__(self, log: Log, poses: ArrayLike, walls: Segments) -> None:
        self.log, self.poses, self.walls = log, poses, arrays.segments(walls)
        self.resolution = slider("cells", 5.0, 1.0, 20.0, 0.5, "cm")
        self.tolerance = slider("tolerance", 4.0, 1.0, 20.0, 0.5, "cm")
        self.tree = W.Checkbox(value=True, description="draw the quadtree")
        self.segments, self.squares = text(), text()
        self._assemble(self.resolution, self.tolerance, self.tree, (self.segments, self.squares))

    def _draw(self, figure: Figure) -> None:
        sizes = {
            "resolution": self.resolution.value / 100,
            "tolerance": self.tolerance.value / 100,
        }
        ways = keep(self.log, self.poses, **sizes)
        self.judged = {found.kept.name: found for found in judge(ways.kept, self.walls)}
        self.segments.value = _words(self.judged["reduced segments"], "segments")
        self.squares.value = _words(self.judged["quadtree"], "leaves")
        ax = figure.subplots()
        if self.tree.value:
            draw_quadtree(ways.map, ax=ax)
        else:
            draw_segments(ways.reduced, ax=ax, color=RESULT, width=2.5)
        draw_segments(self.walls, ax=ax, color=TRUTH, width=0.8)

    def __repr__(self) -> str:
        return f"StoragePanel({self.segments.value}; {self.squares.value})"


def _words(found: Judged, parts: str) -> str:
    kept = found.kept
    return f"{kept.parts} {parts}, {kept.nbytes / 1e3:.1f} kB, {1e3 * found.error:.1f} mm off"
