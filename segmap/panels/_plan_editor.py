"""A floor plan that a person mends by mouse, finger and keyboard."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import anywidget
import numpy as np
import scipy.ndimage  # noqa: F401 -- edits need it: here, so that the first one does not wait for it
import traitlets
from matplotlib.figure import Figure

from .. import arrays
from ..display import plural
from ..plan import FloorPlan, shapely_or_hint
from ..plan.edits import Edit, read
from ..plotting import draw_plan, figure_png

_FOLDER = Path(__file__).parent
#: Empty paper around the building, metres.
MARGIN_M = 0.5
#: Places go to the browser in millimetres.
DIGITS = 3


class PlanEditor(anywidget.AnyWidget):
    """A floor plan, whose rooms are joined, split and named by hand, and whose doors and walls are
    drawn and refused.

    `edits` are what was done, in its order: setting them shows the plan with these, and
    `editor.observe(function, "edits")` follows what a person does. `plan` is the plan that is
    shown. An edit that finds nothing to change is said and not kept.

    Examples
    --------
    >>> from segmap.plan import Name, floor_plan
    >>> from segmap.quadtree import map_of_grid
    >>> walls = [[(0, 0), (4, 0)], [(4, 0), (4, 3)], [(4, 3), (0, 3)], [(0, 3), (0, 0)]]
    >>> free = map_of_grid(np.ones((60, 80)), resolution=0.05)
    >>> editor = PlanEditor(floor_plan(walls, free))
    >>> editor.do(Name((1, 1), "hall"))
    >>> editor.plan.rooms
    [Room('hall', 12.0 m2, 4 corners)]
    >>> editor.undo()
    >>> editor.edits
    ()
    """

    _esm = _FOLDER / "plan.js"
    _css = _FOLDER / "plan.css"
    state = traitlets.Dict().tag(sync=True)
    edits = traitlets.Tuple()

    def __init__(self, plan: FloorPlan, **more: Any) -> None:
        super().__init__(**more)
        self.plan = arrays.instance(plan, "plan", FloorPlan)
        self._undone = list[Edit]()
        self.edits = plan.edits
        self.observe(self._changed, "edits")
        self._show(_said(plan))
        self.on_msg(lambda widget, message, buffers: self._asked(message))

    def _repr_mimebundle_(self, **kwargs: Any) -> tuple[dict[str, Any], dict[str, Any]]:
        """The live plan, and for readers without a kernel its picture and its text."""
        bundle, metadata = super()._repr_mimebundle_(**kwargs) or ({}, {})
        figure = Figure(layout="constrained")
        draw_plan(self.plan, ax=figure.subplots())
        return bundle | {"image/png": figure_png(figure), "text/plain": repr(self)}, metadata

    def __repr__(self) -> str:
        return f"PlanEditor({_said(self.plan)}; {plural(len(self.edits), 'edit')})"

    def do(self, edit: Edit) -> None:
        """Add an edit; one that finds nothing to change is said, and not kept."""
        after = self.plan.edited([*self.edits, edit])
        if len(after.unplaced) > len(self.plan.unplaced):
            before, last = self.plan.unplaced, after.unplaced[-1]
            words = next((words for words in after.unplaced if words not in before), last)
            self._show(f"nothing is changed: {words.removeprefix(f'{edit} ').strip('()')}")
            return
        self._undone.clear()
        self.plan, self.edits = after, after.edits

    def undo(self) -> None:
        """Take the last edit back."""
        if self.edits:
            self._undone.append(self.edits[-1])
            self.edits = self.edits[:-1]

    def redo(self) -> None:
        """Do again what was taken back last."""
        if self._undone:
            self.edits = (*self.edits, self._undone.pop())

    def _asked(self, message: dict[str, Any]) -> None:
        """What a person does in the browser."""
        if "edit" in message:
            self.do(read(message["edit"]))
        elif "undo" in message:
            self.undo()
        elif "redo" in message:
            self.redo()

    def _changed(self, change: Any) -> None:
        if self.plan.edits != change["new"]:
            self.plan = self.plan.edited(change["new"])
        self._show(_said(self.plan))

    def _show(self, words: str) -> None:
        """Draw the plan, and say something below it."""
        shapely, plan = shapely_or_hint(), self.plan
        rooms = [
            {
                "name": room.name,
                "area": room.area,
                "place": _to_millimetres(room.place),
                "clear": shapely.LinearRing(room.outline).distance(shapely.Point(room.place)),
                "rings": [_to_millimetres(ring) for ring in (room.outline, *room.holes)],
            }
            for room in plan.rooms
        ]
        ends = plan.walls.segments.reshape(-1, 2)
        low, high = ends.min(0) - MARGIN_M, ends.max(0) + MARGIN_M
        self.state = {
            "rooms": rooms,
            "wall": _to_millimetres(plan.walls.segments),
            "clutter": _to_millimetres(plan.clutter.segments),
            "doors": [_to_millimetres(door.ends) for door in plan.doors],
            "bounds": _to_millimetres(np.concatenate([low, high])),
            "axis": float(plan.axes[0]) if len(plan.axes) else 0.0,
            "undo": bool(self.edits),
            "redo": bool(self._undone),
            "words": words,
        }


def _said(plan: FloorPlan) -> str:
    """Rooms, their area, doors, and what is in doubt."""
    rooms, doors = plural(len(plan.rooms), "room"), plural(len(plan.doors), "door")
    area = sum(room.area for room in plan.rooms)
    count = f"{rooms} of {area:.1f} m\N{SUPERSCRIPT TWO}, {doors}"
    return "; ".join(filter(None, [count, plan.doubt]))


def _to_millimetres(values: Sequence[Any] | arrays.Array) -> Any:
    return np.round(values, DIGITS).tolist()
