"""What moves in a chapter: figures to drag, films, and a prediction beside its answer.

A figure to drag is a class here and an ES module beside it; `drag.js` is what all modules share. A
new one takes both: see `DragFigure`.
"""

from ._beams_over_squares import DragBeams
from ._drag_figure import FIGURE_MIME, DragFigure, module_text
from ._film import Film, film
from ._line_through_points import DragLine
from ._prediction import Comparison, compare_prediction
from ._scan_on_scan import DragScan
from ._strip_over_segments import DragStrip
from ._two_walls import DragWalls
from ._wardrobe_round_the_corner import DragWardrobe

__all__ = [
    "FIGURE_MIME", "Comparison", "DragBeams", "DragFigure", "DragLine", "DragScan", "DragStrip",
    "DragWalls", "DragWardrobe", "Film", "compare_prediction", "film", "module_text",
]  # fmt: skip
