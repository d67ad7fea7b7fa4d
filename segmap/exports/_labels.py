"""Where words stand on a sheet: on no wall, and on no other words."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..arrays import Array
from ..plan import shapely_or_hint

#: Sizes of letters that are tried, points, the largest first.
LETTER_SIZES_POINTS = (8.0, 7.0, 6.0, 5.0)
#: Points a millimetre.
POINTS_PER_MM = 72 / 25.4
#: From one line of words to the next, sizes of a letter.
LINE_SPACING = 1.25
#: Words keep so far from walls and from each other, millimetres.
WORDS_MARGIN_MM = 0.5
#: Places for words are tried so far from each other at least, millimetres.
LEAST_TRIAL_STEP_MM = 0.75
#: And so many a side of what they must lie in, at most.
MOST_TRIALS_PER_SIDE = 60


@dataclass
class Labels:
    """Words that stand beside each other on a sheet; all lengths in millimetres of the paper.

    Parameters
    ----------
    ax
        Its axes.
    walls
        Where no words stand: a geometry of shapely.
    drawn
        From what they keep away where they can, walls too.
    page
        What words lie in: a polygon of shapely.
    """

    ax: Any
    walls: Any
    drawn: Any
    page: Any
    boxes: list[Any] = field(default_factory=list)

    def write_inside(self, text: str, area: Any) -> bool:
        """Write in the widest free place of an area, as large as fits; whether anything did."""
        shapely = shapely_or_hint()
        for size in LETTER_SIZES_POINTS:
            boxes, middles = self._free_boxes(area, text_size(text, size))
            if len(boxes):
                around = shapely.clip_by_rect(self.drawn, *area.bounds)
                margins = np.fmin(*(shapely.distance(k, boxes) for k in (area.boundary, around)))
                aside = shapely.distance(area.centroid, boxes)  # of places as wide: in the middle
                best = int(np.argmax(margins - 0.01 * aside))
                self._write(text, size, boxes[best], middles[best], "black")
                return True
        return False

    def write_near(self, text: str, place: Array, around: Any, color: str = "black") -> None:
        """Write as near to a place as there is room, with a line to the words; or nothing."""
        shapely, size = shapely_or_hint(), LETTER_SIZES_POINTS[-1]
        boxes, middles = self._free_boxes(around, text_size(text, size))
        leaders = shapely.shortest_line(shapely.Point(place), boxes)
        distances = np.hypot(*(middles - place).T)
        distances[shapely.intersects(leaders, shapely.union_all(self.boxes))] = np.inf
        if not np.isfinite(distances).any():
            return
        best = int(np.argmin(distances))
        if leaders[best].length > 2 * WORDS_MARGIN_MM:
            self.ax.plot(*np.array(leaders[best].coords).T, color=color, linewidth=0.4)
        self._write(text, size, boxes[best], middles[best], color)

    def _free_boxes(self, area: Any, size: Array) -> tuple[Any, Array]:
        """Boxes of this size in an area where nothing stands yet, and their middles `(n, 2)`."""
        shapely = shapely_or_hint()
        area = area.intersection(self.page)
        if area.is_empty:
            return np.zeros(0, object), np.zeros((0, 2))
        low, high = np.reshape(area.bounds, (2, 2))
        step = max(LEAST_TRIAL_STEP_MM, float(np.max(high - low)) / MOST_TRIALS_PER_SIDE)
        across, up = (np.arange(low[k] + size[k] / 2, high[k] - size[k] / 2, step) for k in (0, 1))
        middles = np.stack(np.meshgrid(across, up), -1).reshape(-1, 2)
        half = size / 2 + WORDS_MARGIN_MM
        boxes = shapely.box(*(middles - half).T, *(middles + half).T)
        taken = shapely.union_all(self.boxes)
        shapely.prepare([area, self.walls, taken])
        free = shapely.contains(area, boxes)
        free[free] = ~shapely.intersects(self.walls, boxes[free])
        free[free] = ~shapely.intersects(taken, boxes[free])
        return boxes[free], middles[free]

    def _write(self, text: str, size: float, box: Any, middle: Array, color: str) -> None:
        self.boxes.append(box)
        self.ax.text(
            *middle, text, fontsize=size, color=color, ha="center", va="center",
            linespacing=LINE_SPACING, parse_math=False,
        )  # fmt: skip


def text_size(text: str, size: float) -> Array:
    """Width and height of words in letters of this size, points: `(2,)`, millimetres."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import text_to_path

    lines, font = text.split("\n"), FontProperties(size=size)
    sizes = [text_to_path.get_text_width_height_descent(line, font, False) for line in lines]
    wide = max(wide for wide, _, _ in sizes)
    return np.array([wide, len(lines) * LINE_SPACING * size]) / POINTS_PER_MM
