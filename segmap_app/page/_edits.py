"""What is done to a map by hand: loops left out or forced, turn, crop, place, names of rooms."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import ipywidgets as W

from segmap.panels.controls import ENTRY, folded
from segmap.plan import FloorPlan
from segmap.plan.edits import Edit, read

from ..pipeline import Pipeline
from ..plans import plan_of

#: Entries of numbers, by their options: how many, label and example.
NUMBER_ENTRIES = {
    "crop": (4, "crop [m]", "left low right high"),
    "place": (2, "place of (0, 0)", "latitude longitude"),
    "north": (1, "north [degrees]", "90, which is up"),
}


class Edits:
    """Controls of all edits; `veto` and `tie` are loops as `FIRST-SECOND`.

    Examples
    --------
    >>> edits = Edits()
    >>> edits.square.value, edits.crop.value = True, "0, -5, 20, 5"
    >>> edits.value()
    {'square': True, 'crop': [0.0, -5.0, 20.0, 5.0]}
    """

    def __init__(self) -> None:
        self.veto: list[str] = []
        self.tie: list[str] = []
        #: What is changed in the floor plan, in the frame of the log.
        self.plan: tuple[Edit, ...] = ()
        wide: Any = {"style": ENTRY, "layout": {"width": "auto"}, "continuous_update": False}
        words = "square: most walls along x and y"
        self.square: Any = W.Checkbox(False, description=words, indent=False)
        self.square.layout.width = "auto"
        self.crop, self.place, self.north = (
            W.Text(description=label, placeholder=hint, **wide)
            for _, label, hint in NUMBER_ENTRIES.values()
        )
        self.square.tooltip = "turn the map"
        self.crop.tooltip = "what lies outside of the rectangle is left out, metres of the map"
        self.place.tooltip = "where (0, 0) of the map lies on the earth, for GIS (GeoJSON)"
        self.north.tooltip = "where north is in the map, counter-clockwise from x"
        hint = "EPSG:25832: place is east north"
        self.crs: Any = W.Text(description="grid, not degrees", placeholder=hint, **wide)
        self.drag: Any = W.ToggleButton(False, description="drag it on the map", tooltip="crop")
        self.drag.layout.width = "auto"
        self.controls = [self.square, self.crop, self.place, self.north, self.crs]
        self.crop.layout.flex, self.crop.layout.min_width = "1 1 260px", "0"
        cut = W.Box([self.crop, self.drag], layout=W.Layout(flex_flow="row wrap"))
        self.box = W.VBox([cut, self.place, self.north, self.crs])
        self.open = folded("crop and place", self.box)

    def value(self) -> dict[str, Any]:
        """What is edited, by the options of `segmap map`, as a session keeps it."""
        options: dict[str, Any] = {"veto": [*self.veto], "tie": [*self.tie]}
        options["square"] = self.square.value
        for name, (count, label, hint) in NUMBER_ENTRIES.items():
            text = getattr(self, name).value
            try:
                options[name] = [float(word) for word in text.replace(",", " ").split()]
                assert len(options[name]) in (0, count)
            except (ValueError, AssertionError):
                raise ValueError(f"{label} must be like '{hint}', got {text!r}") from None
        options["crs"], options["edit"] = self.crs.value.strip(), [*map(str, self.plan)]
        return {name: value for name, value in options.items() if value}

    def take_loops(self, held: Mapping[str, Any]) -> None:
        """Leave out and force the loops that these edits name, and no others."""
        self.veto, self.tie = [*held.get("veto", [])], [*held.get("tie", [])]

    def restore(self, held: Mapping[str, Any]) -> None:
        """Set what a session keeps, and nothing else."""
        self.take_loops(held)
        self.plan = tuple(read(text) for text in held.get("edit", []))
        self.square.value, self.crs.value = held.get("square", False), held.get("crs", "")
        for name in NUMBER_ENTRIES:
            value = held.get(name, [])
            numbers = value if isinstance(value, list) else [value]
            getattr(self, name).value = " ".join(map(str, numbers))


class Rooms:
    """A switch; on, the floor plan stands in the place of the map, which canvas.css hides, and a
    person mends it there.

    What is done is kept in the edits, in the frame of the log: another run does it again.
    `begin` calls a function in the worker, `say` says what is done, and `outcome` is what is shown;
    `mended` is called after each edit. `editor` is the plan that stands there, or None.
    """

    def __init__(
        self,
        edits: Edits,
        begin: Callable[..., None],
        say: Callable[[str, float], None],
        outcome: Callable[[], Pipeline | None],
        mended: Callable[[], None],
    ) -> None:
        self.edits, self._begin, self._say, self._outcome = edits, begin, say, outcome
        self._tell_mended = mended
        self.editor: Any = None
        tip = "rooms with their areas, and doors: mend them with the mouse"
        self.switch: Any = W.ToggleButton(False, description="plan", tooltip=tip)
        self.sheet = W.Box()
        self.sheet.add_class("segmap-sheet")
        self.switch.observe(self._switched, names="value")

    @property
    def plan(self) -> FloorPlan | None:
        """The floor plan that is shown."""
        return self.editor.plan if self.editor else None

    def _switched(self, change: Any = None) -> None:
        if not self.switch.value:
            self.editor, self.sheet.children = None, ()
        elif (outcome := self._outcome()) is not None and not self.sheet.children:
            self._begin(plan_of, (outcome, self.edits.plan), self.show)

    def show(self, plan: FloorPlan) -> None:
        """Show a plan, to be mended."""
        from segmap.panels import PlanEditor

        self.editor = PlanEditor(plan)
        self.editor.observe(self._mended, names="edits")
        self.sheet.children = [self.editor]
        self._say("the floor plan is made", 1.0)

    def _mended(self, change: Any) -> None:
        if (outcome := self._outcome()) is not None:
            self.edits.plan = tuple(edit.turned(-outcome.turn) for edit in change["new"])
            self._tell_mended()
