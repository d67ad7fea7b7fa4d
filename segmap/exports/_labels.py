"""Where words stand on a sheet and in a drawing: on no wall, and on no other words."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..arrays import Array
from ..plan import shapely_or_hint

#: Heights of capitals that are tried, millimetres of the paper, the largest first.
LETTERS_MM = (2.5, 2.1, 1.7, 1.3)
#: Points a millimetre.
POINTS_PER_MM = 72 / 25.4
#: The size of a letter, points, for capitals of a millimetre.
POINTS_PER_LETTER_MM = POINTS_PER_MM / 0.729
#: From one line of words to the next, sizes of a letter.
LINE_SPACING = 1.25
#: Words keep so far from walls and from each other, millimetres.
WORDS_MARGIN_MM = 0.5
#: Places for words are tried so far from each other at least, millimetres.
LEAST_TRIAL_STEP_MM = 0.75
#: And so many a side of what they must lie in, at most.
MOST_TRIALS_PER_SIDE = 60


@dataclass(frozen=True)
class Label:
    """Words on paper, of one or two lines; all lengths in millimetres.

    Parameters
    ----------
    text
        Its lines.
    letters
        Height of its capitals.
    middle : (2,) array
        Where they stand.
    leader : (2, 2) array
        A line to what they name, which lies elsewhere; None where they stand on it.
    color
        What words and line are drawn in.
    """

    text: str
    letters: float
    middle: Array
    leader: Array | None
    color: str

    def lines(self) -> Iterator[tuple[str, Array]]:
        """Each line of words, and its middle."""
        lines = self.text.split("\n")
        step = np.array([0, LINE_SPACING * self.letters * POINTS_PER_LETTER_MM / POINTS_PER_MM])
        for number, line in enumerate(lines):
            yield line, self.middle + ((len(lines) - 1) / 2 - number) * step


@dataclass
class Labels:
    """Words that are placed beside each other; all lengths in millimetres of the paper.

    Parameters
    ----------
    walls
        Where no words stand: a geometry of shapely.
    drawn
        From what they keep away where they can, walls too.
    page
        What words lie in: a polygon of shapely.
    placed
        The words that stand already.
    """

    walls: Any
    drawn: Any
    page: Any
    placed: list[Label] = field(default_factory=list)
    _taken: list[Any] = field(default_factory=list)

    def place_inside(self, text: str, area: Any) -> bool:
        """Place in the widest free spot of an area, as large as fits; whether anything did."""
        shapely = shapely_or_hint()
        for letters in LETTERS_MM:
            boxes, middles = self._free_boxes(area, text, letters)
            if len(boxes):
                around = shapely.clip_by_rect(self.drawn, *area.bounds)
                margins = np.fmin(*(shapely.distance(k, boxes) for k in (area.boundary, around)))
                aside = shapely.distance(area.centroid, boxes)  # of places as wide: in the middle
                best = int(np.argmax(margins - 0.01 * aside))
                self.placed.append(Label(text, letters, middles[best], None, "black"))
                self._taken.append(boxes[best])
                return True
        return False

    def place_near(self, text: str, place: Array, around: Any, color: str = "black") -> None:
        """Place as near to a point as there is room, with a line to the words; or nothing."""
        shapely, letters = shapely_or_hint(), LETTERS_MM[-1]
        boxes, middles = self._free_boxes(around, text, letters)
        leaders = shapely.shortest_line(shapely.Point(place), boxes)
        distances = np.hypot(*(middles - place).T)
        distances[shapely.intersects(leaders, shapely.union_all(self._taken))] = np.inf
        if not np.isfinite(distances).any():
            return
        best = int(np.argmin(distances))
        far = leaders[best].length > 2 * WORDS_MARGIN_MM
        leader = np.array(leaders[best].coords) if far else None
        self.placed.append(Label(text, letters, middles[best], leader, color))
        self._taken += [boxes[best], leaders[best]]

    def _free_boxes(self, area: Any, text: str, letters: float) -> tuple[Any, Array]:
        """Boxes for words in an area where nothing stands yet, and their middles `(n, 2)`."""
        shapely, size = shapely_or_hint(), text_size(text, letters * POINTS_PER_LETTER_MM)
        area = area.intersection(self.page)
        if area.is_empty:
            return np.zeros(0, object), np.zeros((0, 2))
        low, high = np.reshape(area.bounds, (2, 2))
        step = max(LEAST_TRIAL_STEP_MM, float(np.max(high - low)) / MOST_TRIALS_PER_SIDE)
        across, up = (np.arange(low[k] + size[k] / 2, high[k] - size[k] / 2, step) for k in (0, 1))
        middles = np.stack(np.meshgrid(across, up), -1).reshape(-1, 2)
        half = size / 2 + WORDS_MARGIN_MM
        boxes = shapely.box(*(middles - half).T, *(middles + half).T)
        taken = shapely.union_all(self._taken)
        shapely.prepare([area, self.walls, taken])
        free = shapely.contains(area, boxes)
        free[free] = ~shapely.intersects(self.walls, boxes[free])
        free[free] = ~shapely.intersects(taken, boxes[free])
        return boxes[free], middles[free]


def text_size(text: str, size: float) -> Array:
    """Width and height of words in letters of this size, points: `(2,)`, millimetres."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import text_to_path

    lines, font = text.split("\n"), FontProperties(size=size)
    sizes = [text_to_path.get_text_width_height_descent(line, font, False) for line in lines]
    wide = max(wide for wide, _, _ in sizes)
    return np.array([wide, len(lines) * LINE_SPACING * size]) / POINTS_PER_MM
