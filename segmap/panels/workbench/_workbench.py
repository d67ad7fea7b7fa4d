"""The whole way on one panel: a log in, a map out, every run kept."""

from __future__ import annotations

import tempfile
import threading
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import ipywidgets as W
import numpy as np

from ... import arrays, exports
from ..._display import counted
from ..._recipe import Outcome, Recipe, begin, follow, world_of
from ...arrays import LIMIT, Array
from ...files import file_name, shown
from ...plotting import thumbnail
from ...progress import told
from ...readers import Session
from ...reduction import Reduction
from ...scans import Log
from ...segments import length
from . import _shown
from ._bar import Bar
from ._choices import WRAP, Choices
from ._job import Worker, said
from ._loops import Loops
from ._source import Source, telling

if TYPE_CHECKING:
    import pandas as pd

#: What is kept of a run, and of which type it is.
COLUMNS: dict[str, type] = {
    **{"map": str, "alignment": str, "align_thresholds": str, "align_seconds": float},
    **{"extraction": str, "extract_thresholds": str, "filtered": float, "verdict": str},
    **{"placed": float, "method": str, "thresholds": str, "n_before": int, "n_after": int},
    **{"reduction": float, "quality": float, "seconds": float},
}
#: What `exports.write_segments` writes.
FORMATS = (".csv", ".npz", ".svg", ".geojson", ".wkt", ".dxf", ".segmap")


class Workbench:
    """Choose a log, an alignment, an extraction, one or two reductions; see, compare and keep.

    A bundled log, a path or an uploaded file is taken. *Run* works in a process of its own, which
    *Stop* ends; a run that fails leaves the last good one. Scans without a pose of their own
    (`Alignment.used`) are left out of the map. A segment that is pointed at shows its members.

    Attributes
    ----------
    align, extract, method, second : choices
        `workbench.method.value = "hybrid"; workbench.method["angle"].value = 5`: angles in degrees.
    people, least : number
        The share for `quadtree.without_passers`, 0 for none; shorter segments, in metres, are left
        out before the reduction.
    deskew : checkbox
        Whether beams are carried to the start of their scan; where they have times only.
    bundled, path, upload : controls
    outcome : Outcome or None
        Alignment, map and reductions of the last good run.
    about, state, verdict, chosen : labels
        What the log is; what happens, or why it does not; whether the map is one; what is pointed
        at.
    shown : buttons
        "before", "after" or "both": which maps are seen.
    loops, edits : controls
        Loops left out and forced, `loops.listed`, `loops.mend`, `loops.tie`; `edits.square`,
        `edits.crop`, `edits.place`, `edits.north`, `edits.crs`: what is edited is run at once.

    Examples
    --------
    >>> from segmap import load
    >>> workbench = Workbench(load("room"))
    >>> workbench.run()
    >>> workbench
    Workbench(room: least_cost leaves 52 of 567 segments, quality 95.1%)
    """

    def __init__(self, log: Log | None = None) -> None:
        if log is not None:
            arrays.instance(log, "log", Log)
        self.outcome: Outcome | None = None
        self._known: Outcome | None = None
        self._rows: list[dict[str, Any]] = []
        self._worker, self._thread, self._bar = Worker(), threading.Thread(), Bar()
        self.progress, self.state = self._bar.bar, self._bar.state
        self._choices = chosen = Choices()
        self.align, self.extract, self.least = chosen.align, chosen.extract, chosen.least
        self.people = chosen.people
        self.method, self.second, self.deskew = chosen.method, chosen.second, chosen.deskew
        self.edits, self.loops = chosen.edits, Loops(chosen.edits, self._looked, self._edited)
        self._make_outputs()
        first: str | Log = "malaga" if log is None else log
        self._source = Source(first, self._taken, self._bar, self._begin)
        self.bundled, self.path, self.upload = self._source.controls
        self.about = self._source.about
        self._view = self._laid_out()

    def open(self, source: str | Path | Log) -> None:
        """Take another log: the name of a bundled one, a path, or a Log; else the one is kept."""
        self._source.open(source)

    @property
    def log(self) -> Log:
        """The log that the next run begins with."""
        return self._source.log

    def _taken(self, log: Log, session: Session | None) -> None:
        """Another log: nothing that was found holds for it; a session has choices and runs."""
        self._known = None
        self._choices.begin(log)
        words = ""
        if session is not None:
            self._choices.restore(session)
            rows = [{name: row.get(name) for name in COLUMNS} for row in session.runs]
            self._rows = [row for row in rows if _is_run(row)]
            self.listed.value = _shown.runs_table(self._rows)
            if refused := len(rows) - len(self._rows):
                words = f"; {refused} of its {counted(len(rows), 'run')} left out: no row of a run"
        self._bar.say(f"{log.name}: ready to run{words}", 0.0)

    # --------------------------------------------------------------------- a run
    def run(self) -> None:
        """Do it, here and now, and show it; where a method refuses, the run before stays."""
        with told(self._bar.tell):
            self._show(self.log, follow(*self._work()))

    def wait(self) -> None:
        """Wait for what a click has begun: a run, or a file that is read."""
        if self._thread.is_alive():
            self._thread.join()

    def _work(self) -> tuple[Recipe, Log, Outcome | None]:
        recipe = self._choices.recipe(self._source.expression)
        return recipe, self.log, self._known

    def _start(self, button: object = None) -> None:
        """Do it in the worker, and show it when it is done."""
        with telling(self._bar.say):
            work = self._work()
            self._begin(begin, work, partial(self._reduce, *work[:2]))

    def _reduce(self, recipe: Recipe, log: Log, begun: Outcome) -> None:
        """Show a new map while it is reduced, and then what is left of it."""
        if log is self.log:
            if not self._is_shown(begun):
                self._show_map(begun)
            self._known = begun
        self._show(log, self._worker.do(follow, recipe, log, begun))

    def _edited(self, change: Any = None) -> None:
        """Run again at once, where there is a map to be edited."""
        if self._known is not None:
            self._start()

    def _looked(self, way: Array, scans: Sequence[int]) -> None:
        """Show the way on the map, and two scans on it; or no longer."""
        if self.canvas is not None:
            self.canvas.look(way, scans)

    def _drawn(self, corners: list[float]) -> None:
        """A rectangle was drawn on the map."""
        self.edits.drag.value, self.edits.crop.value = False, " ".join(map(str, corners))

    def _begin(
        self, function: Callable[..., Any], given: tuple[Any, ...], then: Callable[[Any], None]
    ) -> None:
        """Call a function in the worker, and hand what it returns to another one here."""
        if self._thread.is_alive():
            self._bar.say("something is running: wait for it, or press Stop, then try again")
            return
        self.start.disabled = True
        self._bar.tell(0.0, "starting")
        self._thread = threading.Thread(target=self._wait, args=(function, given, then))
        self._thread.daemon = True
        self._thread.start()
        threading.Thread(target=self._bar.watch, args=[self._thread], daemon=True).start()

    def _wait(
        self, function: Callable[..., Any], given: tuple[Any, ...], then: Callable[[Any], None]
    ) -> None:
        kept = ". The last good run is kept." if self.outcome and function is begin else ""
        try:
            with told(self._bar.tell):
                then(self._worker.do(function, *given))
        except Exception as fault:
            if self.outcome is not None and self.outcome.given is self.log:
                # what cannot be is not tried again
                self.edits.take_loops(self.outcome.recipe.edits)
                if self._known is not self.outcome:
                    self._show_map(self.outcome)
                    self._known = self.outcome
            self._bar.say(f"{said(fault)}{kept}", 0.0)
        finally:
            self.start.disabled = False

    def _stop(self, button: object = None) -> None:
        self._source.stop()
        self._worker.stop()

    def _show(self, log: Log, outcome: Outcome) -> None:
        self.outcome = outcome
        new = outcome.rows(log.name)
        self._rows += [row for row in new if row not in self._rows]  # the other one may be known
        self._show_map(outcome)
        self._known = outcome if log is self.log else None  # another may be chosen meanwhile
        self.figures.value = _shown.left(outcome)
        self.listed.value = _shown.runs_table(self._rows)
        self.listing.value = _shown.code(outcome.recipe.code())
        self._bar.say("done", 1.0)
        self.chosen.value = "point at a segment that is left: what it was made of lights up"

    def _show_map(self, outcome: Outcome) -> None:
        """Show a map, its way and loops, and what is left of it where that is known."""
        map, done = outcome.map, outcome.is_reduced()
        if self.canvas is not None:
            found = [each.segments for each in outcome.reductions] if done else []
            wait = [f"before: {len(map)} segments", "not reduced yet"]
            self.canvas.show(map.segments, found, _shown.titles(outcome) if done else wait)
            self.canvas.summary = _shown.summary(outcome, self.canvas.size) if done else ""
        elif done:
            self.picture.value = _shown.still(outcome)
        self.verdict.value = _shown.placed(outcome)
        self.extracted.value = f"{len(map)} segments of {len(np.unique(map.scan))} scans"
        if not self._is_shown(outcome):
            self.loops.show(outcome)

    def _is_shown(self, outcome: Outcome) -> bool:
        """Whether its map is seen already: who looks at two scans is not disturbed then."""
        known = self._known
        if known is None or known.recipe.mends() != outcome.recipe.mends():
            return False
        return np.array_equal(known.map.segments, outcome.map.segments)

    # --------------------------------------------------------------------- what came out
    @property
    def code(self) -> str:
        """Python that makes what is shown; nothing before the first run."""
        return self.outcome.recipe.code() if self.outcome else ""

    @property
    def runs(self) -> pd.DataFrame:
        """A row for each method of each run."""
        import pandas as pd

        return pd.DataFrame(self._rows, columns=list(COLUMNS))

    def point(self, index: int, which: int = 0) -> Array:
        """Point at a segment that a method left, as the mouse does: its members, `(k, 2, 2)`.

        `which` is 0 for the first method, 1 for the second.
        """
        reduced, map = self._result(which), cast(Outcome, self.outcome).map
        rows = reduced.members(index)
        scans, size = len(np.unique(map.scan[rows])), float(length(reduced.segments[index]))
        self.chosen.value = (
            f"segment {index}: {size:.2f} m, made of {len(rows)} segments of {scans} scans"
        )
        if self.canvas is not None:
            self.canvas.members, self.canvas.pointed = rows.tolist(), [which, int(index)]
        return map.segments[rows]

    def _pointed(self, change: Any) -> None:
        which, index = change["new"]
        if which >= 0:
            with telling(self._bar.say):
                self.point(index, which)
        elif self.canvas is not None:
            self.canvas.members, self.chosen.value = [], ""

    def export(self, path: str | Path, which: int = 0) -> None:
        """Write what a method leaves, as `exports.write_segments` does; 1 for the second.

        A name that ends in `.segmap` keeps the log with all that is chosen, and the runs.
        """
        if arrays.file(path).suffix.lower() == ".segmap":
            session = self._work()[0].session(self.log, self._rows)
            exports.write_session(path, session)
        else:
            result = self._result(which)
            world = world_of(cast(Outcome, self.outcome).recipe.edits)
            exports.write_segments(path, result, world=world)

    def _download(self, button: Any) -> None:
        """Hand the first result to the browser."""
        with telling(self._bar.say), tempfile.TemporaryDirectory() as folder:
            method = self._result().method
            name = cast(Outcome, self.outcome).given.name
            path = Path(folder) / file_name(f"{name}-{method}{button.description}")
            self.export(path)
            self.canvas.save(path.name, path.read_bytes())

    def _result(self, which: int = 0) -> Reduction:
        if self.outcome is None:
            raise ValueError("there is no result yet: run() makes one")
        found = self.outcome.reductions
        return found[arrays.whole(which, "which", least=0, most=len(found) - 1)]

    # --------------------------------------------------------------------- how it looks
    def _make_outputs(self) -> None:
        self.start = W.Button(description="Run", style={"button_color": "#0072b2"})
        self.start.style.text_color = "white"
        self.stop = W.Button(description="Stop")
        for button, done in ((self.start, self._start), (self.stop, self._stop)):
            button.layout.width = "80px"
            button.on_click(done)
        self.verdict, self.extracted, self.figures, self.chosen = (W.HTML() for _ in range(4))
        wide = {"width": "100%", "overflow": "auto"}
        self.listed, self.listing = (W.HTML(layout=W.Layout(**wide)) for _ in range(2))
        named = [W.Button(description=end, tooltip="save the first result") for end in FORMATS]
        for button in named:
            button.layout.width = "auto"
            button.on_click(self._download)
        self.files = W.Box([W.Label("Save the first result as"), *named], layout=W.Layout(**WRAP))
        self.picture: Any = W.Image(format="png")
        self.shown: Any = W.ToggleButtons(options=["before", "after", "both"], value="after")
        self.shown.style.button_width = "80px"
        for control in self.edits.controls:
            control.observe(self._edited, names="value")
        for control in (self.loops.mend, self.loops.tie, *self.edits.controls):
            W.dlink((self.start, "disabled"), (control, "disabled"))
        try:
            from ._canvas import Canvas
        except ImportError:  # anywidget is not installed: a picture instead
            self.canvas: Any = None
            return
        self.canvas = Canvas(self.loops.picked, self._drawn, layout=W.Layout(width="100%"))
        W.link((self.edits.drag, "value"), (self.canvas, "drawing"))
        self.canvas.observe(self._pointed, names="pointed")
        W.link((self.shown, "value"), (self.canvas, "shown"))

    def _laid_out(self) -> Any:
        """The way from step to step at the left, the map at the right; above it where it is narrow.

        All runs below.
        """
        found = (None, self.verdict, self.extracted, self.figures)
        views = {"Log": self._source.view, **self._choices.views()}
        steps: list[Any] = []
        for k, ((name, view), told_of) in enumerate(zip(views.items(), found, strict=True)):
            steps += [W.HTML(_shown.heading(f"{k + 1}  {name}")), view, *filter(None, [told_of])]
        run = W.Box([self.start, self.stop, self.progress], layout=W.Layout(**WRAP))
        seen = [self.picture] if self.canvas is None else [self.shown, self.canvas]
        files = [] if self.canvas is None else [self.files]
        way = W.VBox(steps, layout=W.Layout(flex="1 1 310px", min_width="0", max_width="100%"))
        parts = [self.loops.open, self.edits.open, self.edits.square]
        mend = [W.Box(parts, layout=W.Layout(**WRAP)), self.loops.box, self.edits.box]
        mend = [W.HTML(_shown.heading("Mend the map")), *mend]
        right = [run, self.state, *seen, self.chosen, *files, *mend]
        maps = W.VBox(right, layout=W.Layout(flex="3 1 540px", min_width="0"))
        both = W.Box([way, maps], layout=W.Layout(flex_flow="row wrap", grid_gap="4px 24px"))
        runs = [W.HTML(_shown.heading("All runs")), self.listed]
        code = [W.HTML(_shown.heading("In Python")), self.listing]
        return W.VBox([both, *runs, *code], layout=W.Layout(width="100%", max_width="1500px"))

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, Any]:
        """The live panel, and for readers without a kernel its picture and its text."""
        self._worker.start()  # so that the first run need not wait for it
        bundle: dict[str, Any] = dict(self._view._repr_mimebundle_())
        picture = _shown.still(self.outcome) if self.outcome else thumbnail(self.log)
        return bundle | {"image/png": picture, "text/plain": repr(self)}

    def __repr__(self) -> str:
        if self.outcome is None:
            return f"Workbench({shown(self.log.name)}: not run yet)"
        return f"Workbench({shown(self.outcome.given.name)}: {self.outcome.words()})"


def _is_run(row: Mapping[str, object]) -> bool:
    """Whether all values of a row have the type of their column; whole numbers are numbers too."""
    kinds = {int: (int,), float: (int, float), str: (str,)}
    for name, kind in COLUMNS.items():
        value = row[name]
        if type(value) not in kinds[kind]:
            return False
        if isinstance(value, int | float) and not abs(value) < LIMIT:
            return False
    return True
