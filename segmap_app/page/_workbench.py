"""What the buttons of the page do: a log in, a map out, every run kept."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any, cast

import numpy as np

from segmap import arrays
from segmap.display import plural
from segmap.files import escape, file_name
from segmap.plotting import thumbnail
from segmap.progress import Stopped, told
from segmap.reduction import Reduction
from segmap.scans import Log
from segmap.segments import length

from .. import files
from ..drives import record
from ..pipeline import MapChoices, Pipeline, begin, follow
from . import _edits, _files, _shown
from ._bar import Bar, Work
from ._choices import Choices
from ._job import Failed, Worker
from ._loops import Loops
from ._page import NO_PLANS, SAVES, Page
from ._runs import Runs
from ._source import Source, telling


class Workbench(Page, Work):
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
    outcome : Pipeline or None
        Alignment, map and reductions of the last good run.
    about, state, verdict, chosen : labels
        What the log is; what happens, or why it does not; whether the map is one; what is pointed
        at.
    shown, tool, layers : buttons
        "before", "after" or "both": which maps are seen; whether a click looks or measures a
        "distance" or an "area"; what is drawn with the maps, by name.
    loops, edits : controls
        Loops left out and forced, `loops.listed`, `loops.mend`, `loops.tie`; `edits.square`,
        `edits.crop`, `edits.place`, `edits.north`, `edits.crs`: what is edited is run at once, and
        `undo` takes the last edit back.

    Examples
    --------
    >>> from segmap import load
    >>> workbench = Workbench(load("room"))
    >>> workbench.run()
    >>> workbench
    Workbench(room: least_cost leaves 43 of 568 segments, quality 89.5%)
    """

    def __init__(self, log: Log | None = None) -> None:
        if log is not None:
            arrays.instance(log, "log", Log)
        self.outcome: Pipeline | None = None
        self._known = cast(Pipeline | None, None)
        self._runs, self._history = Runs(), list[Mapping[str, Any]]()
        self.listed = self._runs.listed
        self._worker, self._thread, self._bar = Worker(), threading.Thread(), Bar()
        self.progress, self.state = self._bar.bar, self._bar.state
        self._choices = chosen = Choices()
        self.align, self.extract, self.least = chosen.align, chosen.extract, chosen.least
        self.people, self.deskew = chosen.people, chosen.deskew
        self.method, self.second = chosen.method, chosen.second
        self.edits, self.loops = chosen.edits, Loops(chosen.edits, self._looked, self._edited)
        shown_by = self._begin, self._bar.say, lambda: self.outcome, self._keep_asking
        self.rooms = _edits.Rooms(chosen.edits, *shown_by)
        self._make_outputs(self._told)
        first = "malaga" if log is None else log
        self._source = Source(first, self._taken, self._bar, self._begin)
        self.bundled, self.path, self.upload = self._source.controls
        self.about = self._source.about
        views = {"Log": self._source.view, **chosen.views()}
        self._view = self._laid_out(views, self.listed)
        self._connect()
        self._settle()

    def open(self, source: str | Path | Log) -> None:
        """Take another log: the name of a bundled one, a path, or a Log; else the one is kept."""
        self._source.open(source)

    @property
    def log(self) -> Log:
        """The log that the next run begins with."""
        return self._source.log

    def _taken(self, log: Log, session: files.Session | None) -> None:
        """Another log: nothing that was found holds for it; a session has choices and runs."""
        self.outcome = self._known = None
        self._history.clear()
        self._choices.begin(log)
        self._show_nothing()
        words = ""
        if session is not None:
            self._choices.restore(session)
            if refused := self._runs.take(session.runs):
                count = plural(len(session.runs), "run")
                words = f"; {refused} of its {count} left out: no row of a run"
        self._bar.say(f"{log.name}: ready to run{words}", 0.0)

    # --------------------------------------------------------------------- a run
    def run(self) -> None:
        """Do it, here and now, and show it; where a method refuses, the run before stays."""
        with told(self._bar.tell):
            self._show(self.log, outcome := follow(*self._work(anew=True)))
            if self.layers["free space"].value:
                self._freed(_files.free_space(outcome))
        self._settle()

    def _work(self, *, anew: bool = False) -> tuple[MapChoices, Log, Pipeline | None]:
        """What is to be done, on what is known; of a run that was stopped nothing, if anew."""
        before = None if anew and self._known is not None and self._known.stopped else self._known
        return self._choices.recipe(self._source.expression), self.log, before

    def _start(self, button: object = None) -> None:
        """Do it in the worker, and show it when it is done."""
        with telling(self._bar.wrong):
            work = self._work(anew=button is not None)
            self._worker.grown = partial(self._grown, work[1])
            self._begin(begin, work, partial(self._reduce, *work[:2]))

    def _grown(self, log: Log, *seen: Any) -> None:
        """Show the scans that are placed so far, and what to do with the laser."""
        if log is self.log:
            self.advice.value = _shown.advice(seen[-1])
            self.canvas.grow(*seen[:-1])

    def _drive(self, button: object) -> None:
        """Follow a laser in the worker, until Stop; then map its log."""
        with telling(self._bar.wrong):
            self._worker.grown = self._laser.turning(partial(self._grown, self.log))
            self._begin(record, laser := self._laser.named(), partial(self._driven, laser[2]))

    def _driven(self, path: Path, drive: tuple[Log, str]) -> None:
        """Map the log of a drive, and say why it ended by itself."""
        self._source.take_drive(self._laser.turned(drive[0], path), path)
        work = self._work(anew=True)
        self._worker.grown = partial(self._grown, work[1])
        self._reduce(*work[:2], self._worker.do(begin, *work))
        if drive[1]:
            self._bar.wrong(f"{escape(path)} is mapped, but its end was not asked for: {drive[1]}")

    def _reduce(self, recipe: MapChoices, log: Log, begun: Pipeline) -> None:
        """Show a new map while it is reduced, and then what is left of it."""
        if log is self.log:
            if not self._is_shown(begun):
                self._show_map(begun)
            self._known = begun
        outcome, squares = self._worker.do(follow, recipe, log, begun), None
        if self.layers["free space"].value:
            with suppress(Failed, Stopped):  # the map is seen without it
                squares = self._worker.do(_files.free_space, outcome)
        self._show(log, outcome)
        if squares is not None and log is self.log:
            self._freed(squares)

    def _edited(self, change: Any = None) -> None:
        """Run again at once, where there is a map to be edited."""
        if self._known is not None:
            self._start()

    def _looked(self, way: arrays.Array, scans: Sequence[int]) -> None:
        """Show the way on the map, and two scans on it; or no longer."""
        self.canvas.looked_at = [*scans]

    def _undo(self, button: object) -> None:
        """Take the last edit back."""
        if len(self._history) > 1:
            self._history.pop()
            outcome, self._known = self._known, None  # nothing is run while they are set
            self.edits.restore(self._history[-1])
            self._known = outcome
            self._start()

    def _told(self, said: Mapping[str, Any]) -> None:
        """What was done on the map, or in the table of the runs."""
        with telling(self._bar.wrong):
            if "scan" in said:
                self.loops.picked(int(said["scan"]))
            elif "rectangle" in said:
                corners = np.reshape(said["rectangle"], (2, 2)) + self.canvas.middle
                text = " ".join(map(str, corners.ravel().round(2).tolist()))
                self.edits.drag.value, self.edits.crop.value = False, text
            elif "measured" in said:
                unit = "m\N{SUPERSCRIPT TWO}" if said["measured"] == "area" else "m"
                self.chosen.value = f"{float(said['size']):.3f} {unit}"
            elif "run" in said:
                self.bring_back(int(said["run"]), beside=bool(said["beside"]))

    def bring_back(self, run: int, *, beside: bool = False) -> None:
        """Show a run of the table again, with all that was chosen; or only its map, beside ours."""
        if run not in self._runs.made:
            raise ValueError(f"run {run}: only its figures are kept, choose it and press Run")
        outcome = self._runs.made[run]
        if beside:
            reduction = outcome.reductions[0]
            title = f"run {run}, {escape(outcome.given.name)}: {len(reduction)}"
            self.canvas.beside(reduction.segments, title)
        elif self._thread.is_alive():
            raise ValueError("something is running: wait for it, or press Stop, then try again")
        else:
            self._source.open(outcome.given, outcome.recipe.log)
            self._choices.restore(outcome.recipe.session(outcome.given, ()))
            self._show(outcome.given, outcome)
            self._settle()
            self._layered(run)

    def _failed(self, function: Callable[..., Any]) -> str:
        """Show the last good run again, and say that it is kept."""
        if self.outcome is not None:  # what cannot be is not tried again
            self.edits.take_loops(self.outcome.recipe.edits)
            if self._known is not self.outcome:
                self._show_map(self.outcome)
        if self.canvas.growing:
            self.canvas.growing = False
            if self.outcome is not None:
                self._show_map(self.outcome)
        return ". The last good run is kept." if self.outcome and function is begin else ""

    def _stop(self, button: object = None) -> None:
        self._source.stop()
        self._worker.stop()

    def _show(self, log: Log, outcome: Pipeline) -> None:
        self._runs.add(outcome)
        if log is not self.log:  # another was chosen meanwhile
            self._bar.say(f"{log.name}: done, and listed in All runs", 1.0)
            return
        self._show_map(outcome)
        self.outcome = outcome
        if self._history[-1:] != [outcome.recipe.edits]:
            self._history.append(outcome.recipe.edits)
        self.figures.value = _shown.by_method(outcome)
        self.listing.value = _shown.code(outcome.code())
        self._bar.say(_shown.done(outcome), 1.0)
        self.chosen.value = "point at a segment that is left: what it was made of lights up"

    def _show_map(self, outcome: Pipeline) -> None:
        """Show a map, its way and loops, and what is left of it where that is known."""
        map, done, self.rooms.switch.value = outcome.map, outcome.is_reduced(), False
        reduced_segments = [each.segments for each in outcome.reductions] if done else []
        wait = [f"before: {len(map)} segments", "not reduced yet"]
        poses, loops = outcome.alignment.poses, outcome.alignment.loops()
        ends = loops[["x_first", "y_first", "x_second", "y_second"]].to_numpy(float)
        layers = {"way": poses[:, :2], "sure": outcome.alignment.sure}
        layers["loops"] = ends.reshape(-1, 2, 2)
        titles = _shown.titles(outcome) if done else wait
        self.canvas.show(map.segments, reduced_segments, titles, layers)
        self.canvas.unsaved = True
        self.canvas.summary = _shown.summary(outcome, self.canvas.size) if done else ""
        self.verdict.value = _shown.verdict_html(outcome)
        self.extracted.value = f"{len(map)} segments of {len(np.unique(map.scan))} scans"
        if not self._is_shown(outcome):
            self.loops.show(outcome)
        self._known = outcome
        self._layered()

    def _is_shown(self, outcome: Pipeline) -> bool:
        """Whether its map is seen already: who looks at two scans is not disturbed then."""
        before = self._known
        if before is None or self.canvas.growing:
            return False
        mended = before.recipe.mends() != outcome.recipe.mends()
        return not mended and np.array_equal(before.map.segments, outcome.map.segments)

    # --------------------------------------------------------------------- what came out
    @property
    def code(self) -> str:
        """Python that makes what is shown; nothing before the first run."""
        return self.outcome.code() if self.outcome else ""

    @property
    def runs(self) -> Any:
        """A row for each method of each run, a DataFrame."""
        return self._runs.frame()

    def point(self, index: int, which: int = 0) -> arrays.Array:
        """Point at a segment that a method left, as the mouse does: its members, `(k, 2, 2)`.

        `which` is 0 for the first method, 1 for the second.
        """
        reduced, map = self._result(which), cast(Pipeline, self.outcome).map
        rows = reduced.members(index)
        scans, size = len(np.unique(map.scan[rows])), float(length(reduced.segments[index]))
        self.chosen.value = (
            f"segment {index}: {size:.2f} m, made of {len(rows)} segments of {scans} scans"
        )
        self.canvas.members, self.canvas.pointed = rows.tolist(), [which, int(index)]
        return map.segments[rows]

    def _pointed(self, change: Any) -> None:
        which, index = change["new"]
        if which >= 0:
            with telling(self._bar.say):
                self.point(index, which)
        else:
            self.canvas.members, self.chosen.value = [], ""

    def export(self, path: str | Path) -> None:
        """Write what the first method leaves, as `exports.write_segments` does.

        A name that ends in `.segmap` keeps the log with all that is chosen, and the runs.
        """
        if arrays.file(path).suffix.lower() == ".segmap":
            files.write_session(path, self._session())
        else:
            self._result()
            _files.write_outcome(path, cast(Pipeline, self.outcome))

    def _session(self) -> files.Session:
        outcome = self.outcome if self._known is self.outcome else None
        log = outcome.given if outcome and outcome.stopped else self.log
        return self._work()[0].session(log, self._runs.rows)

    def _download(self, button: Any) -> None:
        """Hand the floor plan that is shown, or else the first result, to the browser.

        One file at a time: of several that come without a click between them browsers take one.
        """
        plan = self.rooms.plan if (end := SAVES[button.description]) not in NO_PLANS else None
        with telling(self._bar.wrong):
            method, outcome = self._result().method, cast(Pipeline, self.outcome)
            way = ["plan" if plan else method, outcome.stopped.replace(" ", "-")]
            name = file_name("-".join(filter(None, [self.log.name, *way])) + end)
            work: tuple[Any, ...] = (name, _files.write_outcome, outcome, plan)
            if end == ".segmap":
                work = (name, files.write_session, self._session())
            self._begin(_files.written, work, self._save, words=f"writing {name}")

    def _save(self, files: Mapping[str, bytes]) -> None:
        for name, content in files.items():
            self.canvas.save(name, content)
        if any(name.endswith(".segmap") for name in files):
            self.canvas.unsaved = False
        self._bar.say(f"handed to the browser: {', '.join(files)}", 1.0)

    def _keep_asking(self) -> None:
        """A session that was saved lacks what is mended now."""
        self.canvas.unsaved = True

    def _result(self, which: int = 0) -> Reduction:
        if self.outcome is None:
            raise ValueError("there is no map yet: press Run (or call run()) first")
        reductions = self.outcome.reductions
        return reductions[arrays.whole(which, "which", least=0, most=len(reductions) - 1)]

    # --------------------------------------------------------------------- how it looks
    def _connect(self) -> None:
        """What is done where a control is touched."""
        pressed = {self.start: self._start, self.stop: self._stop, self.undo: self._undo}
        self._laser.start.on_click(self._drive)
        for button, done in (pressed | dict.fromkeys(self.files.children, self._download)).items():
            button.on_click(done)
        for control in self.edits.controls:
            control.observe(self._edited, names="value")
        for layer in self.layers.values():
            layer.observe(self._layered, names="value")
        self.about.observe(self._settle, names="value")
        self.canvas.observe(self._pointed, names="pointed")

    def _settle(self, change: Any = None, busy: bool | None = None) -> None:
        """Grey what cannot be done now."""
        busy, done = self._thread.is_alive() if busy is None else busy, self.outcome is not None
        self._grey(ready=self._source.ready, busy=busy, done=done, edited=len(self._history) > 1)

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, Any]:
        """The live panel, and for readers without a kernel its picture and its text."""
        self._worker.start()  # so that the first run need not wait for it
        picture = _shown.still(self.outcome) if self.outcome else thumbnail(self.log)
        still = {"image/png": picture, "text/plain": repr(self)}
        return dict(self._view._repr_mimebundle_()) | still

    def __repr__(self) -> str:
        if self.outcome is None:
            return f"Workbench({escape(self.log.name)}: not run yet)"
        return f"Workbench({escape(self.outcome.given.name)}: {self.outcome.summary()})"
