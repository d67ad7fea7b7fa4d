"""What the workbench does with a log: choices, what follows from them, and the same as Python."""

from __future__ import annotations

import copy
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from ... import alignment, extraction, reduction
from ...alignment import Alignment, LiveGraph, Verdict
from ...arrays import declared
from ...exports import Frame, placed_at
from ...metrics import quality, reduction_rate
from ...progress import announce
from ...reduction import Reduction
from ...scans import Log
from ...segments import SegmentMap, main_direction


@dataclass(frozen=True)
class Call:
    """A function of some data by its name, with the thresholds that are not its defaults."""

    name: str
    function: Callable[..., Any]
    thresholds: Mapping[str, Any]

    def run(self, data: Any) -> Any:
        """Call it."""
        return self.function(data, **self.thresholds)

    def arguments(self) -> str:
        """The thresholds as Python writes them, each behind a comma; angles by their degrees."""
        said, written = declared(self.function), ""
        for name, value in self.thresholds.items():
            text = _short(value) if isinstance(value, float) else repr(value)
            if isinstance(value, float) and said[name].read_unit != said[name].unit:
                read = float(f"{said[name].read(value):.6g}")
                exact = said[name].meant(read) == value
                text = f"np.radians({_short(read)})" if exact else repr(float(value))
            written += f", {name}={text}"
        return written

    def words(self) -> str:
        """The thresholds as a person reads them."""
        return self.arguments().removeprefix(", ").replace("=", " ").replace("np.", "")


@dataclass(frozen=True)
class Recipe:
    """All choices of the workbench: `log` is the expression that gives it, `least` the filter.

    `edits` are those of a `Session`.
    """

    log: str
    align: Call
    extract: Call
    least: float
    first: Call
    second: Call | None = None
    deskew: bool = False
    edits: Mapping[str, Any] = field(default_factory=dict)

    def methods(self) -> list[Call]:
        """The one or two methods of reduction."""
        return [self.first] if self.second is None else [self.first, self.second]

    def mends(self) -> tuple[list[tuple[int, ...]], list[tuple[int, ...]]]:
        """Loops that are left out and loops that are forced, by their scans."""
        veto, tie = (
            [tuple(map(int, loop.split("-"))) for loop in self.edits.get(name, [])]
            for name in ("veto", "tie")
        )
        return (veto, tie) if self.align.name == "pose_graph" else ([], [])

    def world(self) -> Frame:
        """Where the map lies on the earth."""
        place, (north,) = self.edits.get("place"), self.edits.get("north", [None])
        if place is None and {"north", "crs"} & {*self.edits}:
            raise ValueError("north and a grid need a place: the one of (0, 0) of the map")
        return placed_at(place, north, self.edits.get("crs"))

    def code(self) -> str:
        """The calls that make the same, to be copied: `map`, `reduced` and `other`."""
        extract, thresholds = self.extract, self.extract.arguments()
        if extract.name != "extract_polylines":
            thresholds = f", extract=segmap.extraction.{extract.name}{thresholds}"
        kept = f".filtered({_short(self.least)})" if self.least else ""
        if "crop" in self.edits:
            kept = f".cropped({', '.join(map(_short, self.edits['crop']))}){kept}"
        lines = [f"log = {self.log}", *(["log = segmap.alignment.deskew(log)"] * self.deskew)]
        if any(self.mends()):
            veto, tie = self.mends()
            graph = f"segmap.alignment.LiveGraph({self.align.arguments().removeprefix(', ')})"
            lines += [f"graph = {graph}", "graph.extend(log)", "graph.refine()"]
            lines.append(f"found = graph.mended({veto=}, {tie=})")
        else:
            lines.append(f"found = {_called(alignment, 'alignment', self.align, 'log')}")
        if "square" in self.edits:
            walls = "segmap.build_map(log, found.trusted)"
            lines.append(f"found = found.turned(-segmap.segments.main_direction({walls}))")
        lines.append(
            f"map = segmap.build_map(log, found.trusted, keep_points=True{thresholds}){kept}"
        )
        for name, call in zip(("reduced", "other"), self.methods(), strict=False):
            lines.append(f"{name} = {_called(reduction, 'reduction', call, 'map')}")
        lines.append("segmap.reduction_rate(map, reduced), segmap.quality(map, reduced)")
        name, world = "map.svg", ""
        if "place" in self.edits:
            name, world = "map.geojson", f", world=segmap.exports.{self.world()!r}"
        lines.append(f'# segmap.exports.write_segments("{name}", reduced{world})')
        body = "\n".join(lines)
        return ("import numpy as np\n\n" if "np." in body else "") + f"import segmap\n\n{body}\n"


@dataclass(frozen=True)
class Outcome:
    """What followed from a recipe: the map after the filter, the verdict on it, and what is left.

    Each method has a reduction and a quality. `log` is the one that was aligned; `solved` its
    alignment before it was turned, `grown` a pose graph before it was mended, and what it gave.
    """

    recipe: Recipe
    log: Log
    alignment: Alignment
    map: SegmentMap
    verdict: Verdict
    reductions: list[Reduction]
    qualities: list[float]
    solved: Alignment
    grown: tuple[LiveGraph, Alignment] | None

    def __getstate__(self) -> dict[str, Any]:
        """What another process is sent: a graph may take hundreds of megabytes."""
        return vars(self) | {"grown": None}

    def found(self) -> list[tuple[Call, Reduction, float]]:
        """Each method with its reduction and its quality."""
        return list(zip(self.recipe.methods(), self.reductions, self.qualities, strict=True))

    def words(self) -> str:
        """What each method leaves, and its quality."""
        return ", ".join(
            f"{call.name} leaves {len(reduced)} of {len(self.map)} segments, quality {kept:.1%}"
            for call, reduced, kept in self.found()
        )

    def rows(self, name: str) -> list[dict[str, Any]]:
        """A row for each method, with the columns of `experiments.sweep`, and the way to the map.

        The log is called by its `name`.
        """
        recipe = self.recipe
        mended = "".join(
            f"; {name} {', '.join(recipe.edits[name])}"
            for name in ("veto", "tie")
            if name in recipe.edits
        )
        way = {
            "map": name,
            "alignment": recipe.align.name,
            "align_thresholds": "de-skewed " * recipe.deskew + recipe.align.words() + mended,
            "align_seconds": round(self.alignment.seconds, 6),
            "extraction": recipe.extract.name,
            "extract_thresholds": recipe.extract.words(),
            "filtered": recipe.least,
            "verdict": self.verdict.grade,
            "placed": self.verdict.placed,
            "n_before": len(self.map),
        }
        return [
            way
            | {
                "method": call.name,
                "thresholds": call.words(),
                "n_after": len(reduced),
                "reduction": round(reduction_rate(self.map, reduced), 9),
                "quality": round(kept, 9),
                "seconds": round(reduced.seconds, 6),
            }
            for call, reduced, kept in self.found()
        ]


def follow(recipe: Recipe, log: Log, before: Outcome | None) -> Outcome:
    """Align, extract, reduce and measure; what is as it was `before`, on this log, is not repeated.

    Raises
    ------
    ValueError
        Where a function refuses its thresholds or the log, or no scan gives a segment.
    """
    if before is not None and before.recipe.deskew == recipe.deskew:
        log = before.log
    else:
        before = None
        if recipe.deskew:
            announce(0.0, f"de-skewing {len(log)} scans")
            log = alignment.deskew(log)
    recipe.world()  # a wrong place is refused now, and not where the map is written
    grown, solved = _solved(recipe, log, before)
    if before is not None and (solved is not before.solved or _way(recipe) != _way(before.recipe)):
        before = None
    if before is not None:
        found, map, verdict = before.alignment, before.map, before.verdict
    else:
        announce(0.0, f"extracting segments by {recipe.extract.name}")
        extract, thresholds = recipe.extract.function, recipe.extract.thresholds
        found = solved
        if "square" in recipe.edits:
            found = solved.turned(-main_direction(extraction.build_map(log, solved.trusted)))
        map = extraction.build_map(
            log, found.trusted, extract=extract, keep_points=True, **thresholds
        )
        verdict = found.verdict_on(map)
        map = map.cropped(*recipe.edits["crop"]) if "crop" in recipe.edits else map
        map = map.filtered(recipe.least) if recipe.least else map
        if not len(map):
            raise ValueError(f"{verdict}; no segment is left: loosen extraction, filter or crop")
    reductions = []
    for call in recipe.methods():
        known = before.found() if before is not None else []
        done = [reduced for was, reduced, _ in known if was == call]
        reductions.append(done[0] if done else _reduced(call, map))
    announce(0.0, "measuring quality")
    kept = [quality(map, each) for each in reductions]
    return Outcome(recipe, log, found, map, verdict, reductions, kept, solved, grown)


def _solved(
    recipe: Recipe, log: Log, before: Outcome | None
) -> tuple[tuple[LiveGraph, Alignment] | None, Alignment]:
    """The poses, and a pose graph that can be mended again; what was found before is taken."""
    grown, veto_and_tie = None, recipe.mends()
    if before is not None and before.recipe.align == recipe.align:
        grown = before.grown
        if before.recipe.mends() == veto_and_tie:
            return grown, before.solved
    if grown is None:
        announce(0.0, f"aligning {len(log)} scans by {recipe.align.name}")
        if recipe.align.name != "pose_graph":
            return None, recipe.align.run(log)
        graph = LiveGraph(**recipe.align.thresholds)
        graph.extend(log)
        grown = graph, graph.refine()
    if not any(veto_and_tie):
        return grown, grown[1]
    announce(0.0, "mending the graph")
    return grown, copy.deepcopy(grown[0]).mended(*veto_and_tie)


def _way(recipe: Recipe) -> tuple[object, ...]:
    """All that leads from poses to a map."""
    return recipe.extract, recipe.least, *map(recipe.edits.get, ("square", "crop"))


def _reduced(call: Call, map: SegmentMap) -> Reduction:
    announce(0.0, f"reducing {len(map)} segments by {call.name}")
    reduced = call.run(map)
    if not isinstance(reduced, Reduction):
        raise ValueError(f"{call.name} must return a Reduction, got {type(reduced).__name__}")
    return reduced


def _called(room: Any, name: str, call: Call, data: str) -> str:
    """A call of a method, by its own name where the room exports it, else out of METHODS."""
    own = getattr(room, call.name, None) is call.function
    path = f"segmap.{name}.{call.name}" if own else f"segmap.{name}.METHODS[{call.name!r}]"
    return f"{path}({data}{call.arguments()})"


def _short(value: float) -> str:
    """A number as short as it can be written without becoming another one."""
    brief = f"{value:.6g}"
    return brief if float(brief) == value else repr(float(value))
