"""The page and its buttons: steps in a column, beside them the map; canvas.css says how wide."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import ipywidgets as W
import numpy as np

from segmap.arrays import Array

from . import _files, _shown
from ._browser import Canvas
from ._choices import WRAP
from ._edits import Edits, Rooms
from ._loops import Loops
from ._source import Laser

#: Names for people of what is written of a result, and the ends of their files.
SAVES = {
    "Drawing (DXF)": ".dxf",
    "Picture (PNG)": ".png",
    "Picture (SVG)": ".svg",
    "Sheet to print (PDF)": ".pdf",
    "GIS (GeoJSON)": ".geojson",
    "Robot (ROS map)": ".yaml",
    "Table (CSV)": ".csv",
    "Session": ".segmap",
}
#: What is pressed, and what it does.
PRESSED = {
    "Run": "make the map of this log with all that is chosen",
    "Stop": "end what is done now",
    "Undo": "take the last edit of the map back",
}
#: Their ends where they hold the map also while the floor plan is shown.
NO_PLANS = (".yaml", ".segmap")
#: What is saved, above the buttons: without and with a floor plan.
SAVED = ("Save the map", "Save the floor plan")
TITLE = '<h1 style="font-size: 17px; margin: 4px 0">From a log of a laser to a map</h1>'
#: What may be drawn with the maps, and what each is.
LAYERS = {
    "path": "where the robot went; where that is doubtful, in orange",
    "loops": "places that were found again",
    "points": "where the beams ended",
    "free space": "what beams crossed: the leaves of the quadtree that are free, in grey",
    "grid": "lines of the map's own coordinates, in metres",
}
#: Layers that are drawn where nobody says anything.
DRAWN_LAYERS = ("path", "loops", "free space")
TOOLS = {
    "look": "a click pins the segment under it",
    "distance": "between two clicks, which snap to ends, corners and walls; wall to wall square",
    "area": "of the polygon that the clicks make; Escape begins anew",
}


def toggles() -> tuple[Any, Any, dict[str, Any]]:
    """Buttons of what is shown and of what a click does, and ticks of the layers by name."""
    sides: Any = W.ToggleButtons(options=["before", "after", "both"], value="after")
    tool: Any = W.ToggleButtons(options=list(TOOLS), tooltips=list(TOOLS.values()))
    layers = {
        name: W.Checkbox(name in DRAWN_LAYERS, description=name, indent=False, tooltip=LAYERS[name])
        for name in LAYERS
    }
    for each in (sides, tool):
        each.style.button_width = "auto"
    for layer in layers.values():
        layer.layout.width = "auto"
    return sides, tool, layers


def headed(name: str, *parts: Any) -> list[Any]:
    """A step below its heading."""
    return [W.HTML(_shown.heading(name)), *parts]


def laid_out(steps: Sequence[Any], bar: Sequence[Any], seen: Sequence[Any]) -> Any:
    """Steps with their headings, controls that are always seen, and what shows the map."""
    way: list[Any] = [W.HTML(TITLE), *steps]
    boxes = [W.Box(bar, layout=W.Layout(**WRAP)), W.VBox(way), W.VBox(seen)]
    for box, name in zip(boxes, ("bar", "steps", "map"), strict=True):
        box.add_class(f"segmap-{name}")
    page = W.Box(boxes, layout=W.Layout(width="100%"))
    page.add_class("segmap-page")
    _add_tooltips(page)
    return page


class Page:
    """The controls of what is seen and done, and where all controls stand.

    `told` is called with what is done on the map.
    """

    edits: Edits
    loops: Loops
    rooms: Rooms
    progress: Any
    state: Any
    #: The outcome whose map is drawn, what is under way, and what says how far it is.
    _known: Any
    _begin: Any
    _thread: Any
    _bar: Any

    def _make_outputs(self, told: Callable[[dict[str, Any]], None]) -> None:
        self.start, self.stop, self.undo = (
            W.Button(description=word, tooltip=tip, layout=W.Layout(width="80px"))
            for word, tip in PRESSED.items()
        )
        self.start.style.button_color, self.start.style.text_color = "#0072b2", "white"
        self.verdict, self.extracted, self.figures, self.chosen = (W.HTML() for _ in range(4))
        self.chosen.add_class("segmap-state")
        self.advice, self._laser = W.HTML(), Laser()
        self.advice.add_class("segmap-advice")
        self.listing = W.HTML(layout=W.Layout(width="100%", overflow="auto"))
        named = [W.Button(description=name, tooltip=f"save as {SAVES[name]}") for name in SAVES]
        for button in named:
            button.layout.width = "auto"
        self.files = W.Box(named, layout=W.Layout(**WRAP))
        self.shown, self.tool, self.layers = toggles()
        self.canvas: Any = Canvas(told)
        self.canvas.add_class("segmap-view")
        linked = {"shown": self.shown, "tool": self.tool, "drawing": self.edits.drag}
        for name, each in linked.items():
            W.link((each, "value"), (self.canvas, name))

    def _laid_out(self, views: Mapping[str, Any], listed: Any) -> Any:
        """The steps by their names, and the table of all runs."""
        reports = (None, self.verdict, self.extracted, self.figures)
        steps: list[Any] = []
        for k, ((name, view), told_of) in enumerate(zip(views.items(), reports, strict=True), 1):
            steps += headed(f"{k}  {name}", view, *filter(None, [told_of]))
            steps += headed("or Live", self._laser.view) if name == "Log" else []
        saved, sheet = W.HTML(_shown.heading(SAVED[0])), self.rooms.sheet

        def tell_saved(change: Any) -> None:
            saved.value = _shown.heading(SAVED[bool(sheet.children)])

        sheet.observe(tell_saved, names="children")
        row = W.Box([self.loops.open, self.edits.open, self.undo], layout=W.Layout(**WRAP))
        parts = [row, self.edits.square, self.loops.box, self.edits.box]
        steps += headed("Mend the map", *parts)
        steps += [*headed("Floor plan", self.rooms.switch), saved, self.files]
        steps += [*headed("All runs", listed), *headed("In Python", self.listing)]
        bar = [self.start, self.stop, self.progress, self.state]
        groups = {"shown": [self.shown], "measure": [self.tool], "layers": self.layers.values()}
        tools = W.Box(
            [W.Box([W.Label(name), *parts], layout=WRAP) for name, parts in groups.items()],
            layout=WRAP,
        )
        return laid_out(
            steps, bar, [tools, self.advice, self.canvas, self.chosen, self.rooms.sheet]
        )

    def _layered(self, change: Any = None) -> None:
        """What is drawn with the maps; what takes time is made when it is first asked for."""
        on, canvas = [name for name, each in self.layers.items() if each.value], self.canvas
        canvas.layers = on
        if (seen := self._known) is None:
            return
        if "points" in on and not canvas.points:
            canvas.points = canvas.packed(_files.drawn_points(seen.log, seen.alignment.trusted))
        asked = change is not None and "free space" in on
        if asked and not canvas.free and not self._thread.is_alive():
            self._begin(_files.free_space, (seen,), self._freed)

    def _freed(self, squares: Array) -> None:
        squares[:, :2] -= self.canvas.middle
        self.canvas.free = squares.astype(np.float32).tobytes()
        self._bar.say(_shown.done(self._known), 1.0)

    def _show_nothing(self) -> None:
        """Show no map, and nothing that is said of one."""
        self.rooms.switch.value = self.loops.open.value = False
        self.loops.open.layout.display = "none"
        for each in (self.verdict, self.extracted, self.figures, self.listing, self.chosen):
            each.value = ""
        self.canvas.clear()

    def _grey(self, *, ready: bool, busy: bool, done: bool, edited: bool) -> None:
        """Grey what cannot be done: where no log is `ready`, while `busy`, before a run is done."""
        self.stop.disabled, self.undo.disabled = not busy, busy or not edited
        self._laser.start.disabled = busy
        self.advice.value = self.advice.value * busy
        for each in (self.loops.mend, self.loops.tie, *self.edits.controls):
            each.disabled = busy
        for each in (*self.files.children, self.edits.drag, self.rooms.switch):
            each.disabled = busy or not done
        for each in (self.shown, self.tool, *self.layers.values()):
            each.disabled = not done
        self.start.disabled = busy or not ready  # the last: who sees it ready finds all else so


def _add_tooltips(page: Any) -> None:
    """Give each control that has none a tooltip: else its label says "null"."""
    for child in getattr(page, "children", ()):
        if getattr(child, "description", "") and child.has_trait("tooltip"):
            child.tooltip = child.tooltip or child.description
        _add_tooltips(child)
