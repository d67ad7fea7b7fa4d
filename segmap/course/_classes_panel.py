"""What of a map another program takes for free, unknown and occupied."""

from matplotlib.figure import Figure

from ..exports import Classes, ros_classes
from ..panels import Panel, slider, text
from ..quadtree import QuadtreeMap
from ._draw_cells import draw_classes


class ClassesPanel(Panel):
    """The picture that a robot would get of a map, with both thresholds on sliders.

    Parameters
    ----------
    map : QuadtreeMap

    Attributes
    ----------
    occupied, free : sliders
        Occupancy above, and at most which, a cell is so.
    doublings : slider
        How often the side of a pixel is doubled.
    counts, size : labels
    classes : Classes
        What is drawn.

    Examples
    --------
    >>> map = QuadtreeMap(resolution=0.5, size=4, bias=1)
    >>> map.insert_scan((0.2, 0.2), [(1.2, 0.2)])
    >>> panel = ClassesPanel(map)
    >>> panel.counts.value
    '15 free, 0 unknown, 1 occupied'
    """

    classes: Classes

    def __init__(self, map: QuadtreeMap) -> None:
        self.map = map
        self.occupied = slider("occupied above", 0.5, 0.5, 0.95, 0.05, "")
        self.free = slider("free up to", 0.25, 0.0, 0.45, 0.05, "")
        self.doublings = slider("doublings", 0, 0, min(4, map.tree.level), 1, "")
        self.counts, self.size = text(), text()
        self._assemble(self.occupied, self.free, self.doublings, (self.counts, self.size))

    def _draw(self, figure: Figure) -> None:
        found = self.classes = ros_classes(
            self.map,
            resolution=self.map.resolution * 2.0**self.doublings.value,
            occupied=self.occupied.value,
            free=self.free.value,
        )
        rows, columns = found.greys.shape
        free, unknown, occupied = ((found.greys == grey).sum() for grey in (254, 205, 0))
        self.counts.value = f"{free} free, {unknown} unknown, {occupied} occupied"
        self.size.value = f"{columns} x {rows} pixels of {found.side:.3g} m"
        draw_classes(found, ax=figure.subplots())

    def __repr__(self) -> str:
        return f"ClassesPanel({self.counts.value})"
