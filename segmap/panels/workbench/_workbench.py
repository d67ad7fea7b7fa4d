"""The whole way on one panel: a log in, a map out, every run kept."""

from __future__ import annotations

import html
import tempfile
import threading
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import ipywidgets as W
import numpy as np

from ... import arrays, exports
from ...arrays import Array
from ...plotting import thumbnail
from ...reduction import Reduction
from ...scans import Log
from ...scans.moving import is_timed
from ...segments import length
from . import _shown
from ._choices import WRAP, Choices
from ._job import Failed, Stopped, Worker, said
from ._recipe import Outcome, Recipe, follow
from ._source import Source, telling

if TYPE_CHECKING:
    import pandas as pd

COLUMNS = (
    *("map", "alignment", "align_thresholds", "align_seconds", "extraction"),
    *("extract_thresholds", "filtered", "verdict", "placed", "method", "thresholds"),
    *("n_before", "n_after", "reduction", "quality", "seconds"),
)
#: What `exports.write_segments` writes.
FORMATS = (".csv", ".npz", ".svg", ".geojson", ".wkt", ".dxf")


class Workbench:
    """Choose a log, an alignment, an extraction, one or two reductions; see, compare and keep.

    A bundled log, a path or an uploaded file is taken. *Run* works in a process of its own, which
    *Stop* ends; a run that fails leaves the last good one. Scans without a pose of their own
    (`Alignment.used`) are left out of the map. A segment that is pointed at shows its members.

    Attributes
    ----------
    align, extract, method, second : choices
        `workbench.method.value = "hybrid"; workbench.method["angle"].value = 5`: angles in degrees.
    least : number, metres
        Shorter segments are left out before the reduction.
    deskew : checkbox
        Whether beams are carried to the start of their scan; where they have times only.
    bundled, path, upload : controls
    outcome : Outcome or None
        Alignment, map and reductions of the last good run.
    about, state, verdict, chosen : labels
        What the log is; what happens, or why it does not; whether the map is one; what is pointed
        at.

    Examples
    --------
    >>> from segmap import load
    >>> workbench = Workbench(load("room"))
    >>> workbench.align.value = "ground_truth"
    >>> workbench.run()
    >>> workbench
    Workbench(room: fusion leaves 45 of 567 segments, quality 92.7%)
    """

    def __init__(self, log: Log | None = None) -> None:
        if log is not None:
            arrays.instance(log, "log", Log)
        self.outcome: Outcome | None = None
        self._known: Outcome | None = None
        self._rows: list[dict[str, Any]] = []
        self._worker, self._thread = Worker(), threading.Thread()
        self._choices = chosen = Choices()
        self.align, self.extract, self.least = chosen.align, chosen.extract, chosen.least
        self.method, self.second, self.deskew = chosen.method, chosen.second, chosen.deskew
        self._make_outputs()
        self._source = Source("malaga" if log is None else log, self._taken, self._say)
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

    def _taken(self, log: Log) -> None:
        """Another log: nothing that was found holds for it."""
        self._known = None
        self._choices.begin(log)
        self._say(f"{log.name}: ready to run")

    # --------------------------------------------------------------------- a run
    def run(self) -> None:
        """Do it, here and now, and show it; where a method refuses, the run before stays."""
        self._show(self.log, follow(*self._work(), self._tell))

    def _work(self) -> tuple[Recipe, Log, Outcome | None]:
        recipe = self._choices.recipe(self._source.expression, timed=is_timed(self.log))
        return recipe, self.log, self._known

    def _start(self, button: object = None) -> None:
        """Do it in the worker, and show it when it is done."""
        if not self._thread.is_alive():
            with telling(self._say):
                work = self._work()
                self._thread = threading.Thread(target=self._wait, args=(work,), daemon=True)
                self._thread.start()

    def _wait(self, work: tuple[Any, ...]) -> None:
        self.start.disabled, self.progress.value = True, 0
        kept = " The last good run is kept." if self.outcome else ""
        try:
            self._show(work[1], self._worker.do(follow, *work, tell=self._tell))
        except Stopped:
            self._say(f"stopped.{kept}")
        except Failed as fault:
            self._say(f"{fault}.{kept}")
        except Exception as fault:
            self._say(f"{said(fault)}.{kept}")
        finally:
            self.start.disabled = False

    def _stop(self, button: object = None) -> None:
        self._worker.stop()

    def _say(self, text: str) -> None:
        self.state.value = html.escape(text)

    def _tell(self, text: str) -> None:
        self._say(f"{text} ...")
        self.progress.value += 1

    def _show(self, log: Log, outcome: Outcome) -> None:
        self.outcome = outcome
        self._known = outcome if log is self.log else None  # another may be chosen meanwhile
        new = outcome.rows(log.name)
        self._rows += [row for row in new if row not in self._rows]  # the other one may be known
        found, titles = outcome.reductions, _shown.titles(outcome)
        if self.canvas is not None:
            segments = [each.segments for each in found]
            self.canvas.show(outcome.map.segments, segments, titles)
        else:
            self.picture.value = _shown.still(outcome)
        self.verdict.value = _shown.verdict_line(outcome.verdict)
        self.figures.value = _shown.figures_table(outcome)
        self.plane.value = _shown.plane(self._rows)
        self.listed.value = _shown.runs_table(self._rows)
        self.listing.value = (
            f'<pre style="line-height: 1.4">{html.escape(outcome.recipe.code())}</pre>'
        )
        self.progress.value, self.state.value = self.progress.max, "done"
        self.chosen.value = "point at a segment that is left: its members show in the map before"

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
            with telling(self._say):
                self.point(index, which)
        elif self.canvas is not None:
            self.canvas.members, self.chosen.value = [], ""

    def export(self, path: str | Path, which: int = 0) -> None:
        """Write what a method leaves, as `exports.write_segments` does; 1 for the second."""
        exports.write_segments(path, self._result(which))

    def _download(self, button: Any) -> None:
        """Hand the first result to the browser."""
        with telling(self._say), tempfile.TemporaryDirectory() as folder:
            method = self._result().method
            path = Path(folder) / f"{self._rows[-1]['map']}-{method}{button.description}"
            self.export(path)
            self.canvas.save(path.name, path.read_bytes())

    def _result(self, which: int = 0) -> Reduction:
        if self.outcome is None:
            raise ValueError("there is no result yet: run() makes one")
        found = self.outcome.reductions
        return found[arrays.whole(which, "which", least=0, most=len(found) - 1)]

    # --------------------------------------------------------------------- how it looks
    def _make_outputs(self) -> None:
        self.start = W.Button(description="Run", button_style="primary")
        self.stop = W.Button(description="Stop")
        self.start.on_click(self._start)
        self.stop.on_click(self._stop)
        self.progress: Any = W.IntProgress(max=5, layout=W.Layout(width="120px"))
        self.state, self.chosen = W.HTML(), W.Label()
        self.verdict, self.figures, self.plane = (W.HTML() for _ in range(3))
        self.listed, self.listing = W.HTML(), W.HTML()
        try:
            from ._canvas import Canvas
        except ImportError:  # anywidget is not installed: a picture instead
            self.canvas: Any = None
        else:
            self.canvas = Canvas(layout=W.Layout(width="100%"))
        named = [W.Button(description=end, layout=W.Layout(width="auto")) for end in FORMATS]
        for button in named:
            button.on_click(self._download)
        self.files = W.Box([W.Label("Save the first result as"), *named], layout=W.Layout(**WRAP))
        self.picture: Any = W.Image(format="png")
        if self.canvas is not None:
            self.canvas.observe(self._pointed, names="pointed")

    def _laid_out(self) -> Any:
        wrap = W.Layout(**WRAP)
        steps = {"Log": self._source.view, **self._choices.views()}
        run = W.Box([self.start, self.stop, self.progress, self.state], layout=wrap)
        seen = self.picture if self.canvas is None else self.canvas
        kept = W.Tab(
            [W.Box([self.plane, self.listed], layout=wrap), self.listing],
            titles=["All runs", "In Python"],
        )
        tabs = W.Tab(list(steps.values()), titles=list(steps))
        files = [] if self.canvas is None else [self.files]
        parts = [tabs, run, self.verdict, seen, self.chosen, self.figures, *files, kept]
        return W.VBox(parts, layout=W.Layout(width="100%", max_width="1200px"))

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, Any]:
        """The live panel, and for readers without a kernel its picture and its text."""
        bundle: dict[str, Any] = dict(self._view._repr_mimebundle_())
        picture = _shown.still(self.outcome) if self.outcome else thumbnail(self.log)
        return bundle | {"image/png": picture, "text/plain": repr(self)}

    def __repr__(self) -> str:
        if self.outcome is None:
            return f"Workbench({self.log.name}: not run yet)"
        return f"Workbench({self._rows[-1]['map']}: {self.outcome.words()})"
