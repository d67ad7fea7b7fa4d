"""The panel of the chapter on floor plans: what two thresholds make of one map."""

from __future__ import annotations

from matplotlib.figure import Figure

from segmap.arrays import Segments
from segmap.plan import FloorPlan, floor_plan
from segmap.plotting import draw_plan
from segmap.quadtree import QuadtreeMap

from ._lesson import LessonPanel, keyword, note, slide


class PlanPanel(LessonPanel):
    """A floor plan, `plan`, of one map by another kappa or band; a room that lights up says why."""

    method = floor_plan
    plan: FloorPlan
    kappa = keyword(0.1, 3.0, 0.05)
    band = keyword(0.02, 0.5, 0.01)
    room = slide(1, 1, 12, 1, "", label="room that lights up")
    count = why = note()
    rows = ("kappa", "band", "room", "count", "why")
    words = "kappa {kappa}, band {band} m: {count}; room {room} lights up"

    def __init__(self, walls: Segments, free: QuadtreeMap) -> None:
        self.walls, self.free = walls, free
        self._begin()

    def _draw(self, figure: Figure) -> None:
        self.plan = floor_plan(self.walls, self.free, **self.chosen())
        rooms, lit = self.plan.rooms, self.room.value - 1
        area = sum(room.area for room in rooms)
        self.count.value = f"{len(rooms)} rooms of {area:.0f} m2, {len(self.plan.doors)} doors"
        said = "there is no such room"
        if lit < len(rooms):
            said = f"{rooms[lit].name}, {rooms[lit].area:.1f} m2: {rooms[lit].reason}"
        self.why.value = said
        draw_plan(self.plan, lit=lit, ax=figure.subplots())
