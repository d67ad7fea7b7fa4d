"""What the workbench does with a log: choices, what follows from them, and the same as Python."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from ... import alignment, extraction, reduction
from ...alignment import Alignment, Verdict
from ...arrays import declared
from ...metrics import quality, reduction_rate
from ...progress import announce
from ...reduction import Reduction
from ...scans import Log
from ...segments import SegmentMap


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
    """All choices of the workbench: `log` is the expression that gives it, `least` the filter."""

    log: str
    align: Call
    extract: Call
    least: float
    first: Call
    second: Call | None = None
    deskew: bool = False

    def methods(self) -> list[Call]:
        """The one or two methods of reduction."""
        return [self.first] if self.second is None else [self.first, self.second]

    def code(self) -> str:
        """The calls that make the same, to be copied: `map`, `reduced` and `other`."""
        extract, thresholds = self.extract, self.extract.arguments()
        if extract.name != "extract_polylines":
            thresholds = f", extract=segmap.extraction.{extract.name}{thresholds}"
        kept = f".filtered({_short(self.least)})" if self.least else ""
        found = _called(alignment, "alignment", self.align, "log")
        lines = [
            f"log = {self.log}",
            *(["log = segmap.alignment.deskew(log)"] * self.deskew),
            f"found = {found}",
            f"map = segmap.build_map(log, found.trusted, keep_points=True{thresholds}){kept}",
        ]
        for name, call in zip(("reduced", "other"), self.methods(), strict=False):
            lines.append(f"{name} = {_called(reduction, 'reduction', call, 'map')}")
        lines.append("segmap.reduction_rate(map, reduced), segmap.quality(map, reduced)")
        lines.append('# segmap.exports.write_segments("map.svg", reduced)')
        body = "\n".join(lines)
        return ("import numpy as np\n\n" if "np." in body else "") + f"import segmap\n\n{body}\n"


@dataclass(frozen=True)
class Outcome:
    """What followed from a recipe: the map after the filter, the verdict on it, and what is left.

    Each method has a reduction and a quality. `log` is the one that was aligned.
    """

    recipe: Recipe
    log: Log
    alignment: Alignment
    map: SegmentMap
    verdict: Verdict
    reductions: list[Reduction]
    qualities: list[float]

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
        way = {
            "map": name,
            "alignment": recipe.align.name,
            "align_thresholds": "de-skewed " * recipe.deskew + recipe.align.words(),
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
    if before is not None and before.recipe.align == recipe.align:
        found = before.alignment
    else:
        before = None
        announce(0.0, f"aligning {len(log)} scans by {recipe.align.name}")
        found = recipe.align.run(log)
    how = recipe.extract, recipe.least
    if before is not None and (before.recipe.extract, before.recipe.least) == how:
        map, verdict = before.map, before.verdict
    else:
        before = None
        announce(0.0, f"extracting segments by {recipe.extract.name}")
        extract, thresholds = recipe.extract.function, recipe.extract.thresholds
        map = extraction.build_map(
            log, found.trusted, extract=extract, keep_points=True, **thresholds
        )
        verdict = found.verdict_on(map)
        map = map.filtered(recipe.least) if recipe.least else map
        if not len(map):
            raise ValueError(f"{verdict}; no segment is left: loosen the extraction or the filter")
    reductions = []
    for call in recipe.methods():
        known = before.found() if before is not None else []
        done = [reduced for was, reduced, _ in known if was == call]
        reductions.append(done[0] if done else _reduced(call, map))
    announce(0.0, "measuring quality")
    kept = [quality(map, each) for each in reductions]
    return Outcome(recipe, log, found, map, verdict, reductions, kept)


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
