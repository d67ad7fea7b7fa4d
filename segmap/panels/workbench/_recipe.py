"""What the workbench does with a log: choices, what follows from them, and the same as Python."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ... import alignment, extraction, reduction
from ...alignment import Alignment
from ...metrics import quality, reduction_rate
from ...reduction import Reduction
from ...scans import Log
from ...segments import SegmentMap

#: Ways to find the segments of a scan; both tell the points behind each.
EXTRACTIONS: dict[str, Callable[..., Any]] = {
    "extract_polylines": extraction.extract_polylines,
    "extract_clusters": extraction.extract_clusters,
}
#: Says what is being done, before it is done.
Tell = Callable[[str], None]


@dataclass(frozen=True)
class Call:
    """A function by its name, with the thresholds that are not its defaults.

    Parameters
    ----------
    name : str
    function : callable
        `function(data, **thresholds)`.
    thresholds : mapping
    angles : frozenset of str
        Those in radians, which people read in degrees.
    """

    name: str
    function: Callable[..., Any]
    thresholds: Mapping[str, Any]
    angles: frozenset[str] = frozenset()

    def run(self, data: Any) -> Any:
        """Call it."""
        return self.function(data, **self.thresholds)

    def arguments(self) -> str:
        """The thresholds as Python writes them, each behind a comma."""
        return "".join(f", {name}={self._written(name)}" for name in self.thresholds)

    def words(self) -> str:
        """The thresholds as a person reads them."""
        return self.arguments().removeprefix(", ").replace("=", " ").replace("np.", "")

    def _written(self, name: str) -> str:
        value = self.thresholds[name]
        if name in self.angles and value is not None:
            degrees = float(f"{np.degrees(value):.6g}")
            exact = float(np.radians(degrees)) == value
            return f"np.radians({_short(degrees)})" if exact else repr(float(value))
        return _short(value) if isinstance(value, float) else repr(value)


@dataclass(frozen=True)
class Recipe:
    """All choices of the workbench.

    Parameters
    ----------
    log : str
        The expression that gives the log.
    align, extract, first : Call
    second : Call or None
    least : float, metres
        Shorter segments are left out before a method sees them; 0 for none.
    """

    log: str
    align: Call
    extract: Call
    least: float
    first: Call
    second: Call | None = None

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
    """What followed from a recipe.

    Parameters
    ----------
    recipe : Recipe
    alignment : Alignment
    map : SegmentMap
        After the filter.
    reductions : list of Reduction
        One for each method of the recipe.
    qualities : list of float
        Of each, in [0, 1].
    """

    recipe: Recipe
    alignment: Alignment
    map: SegmentMap
    reductions: list[Reduction]
    qualities: list[float]

    def known(self) -> list[tuple[Call, Reduction]]:
        """Each method with its reduction."""
        return list(zip(self.recipe.methods(), self.reductions, strict=True))

    def words(self) -> str:
        """What each method leaves, and its quality."""
        found = zip(self.recipe.methods(), self.reductions, self.qualities, strict=True)
        return ", ".join(
            f"{call.name} leaves {len(reduced)} of {len(self.map)} segments, quality {kept:.1%}"
            for call, reduced, kept in found
        )

    def rows(self, name: str) -> list[dict[str, Any]]:
        """A row for each method, with the columns of `experiments.sweep`, and the way to the map.

        The log is called by its `name`.
        """
        recipe, found = self.recipe, zip(self.reductions, self.qualities, strict=True)
        way = {
            "map": name,
            "alignment": recipe.align.name,
            "align_thresholds": recipe.align.words(),
            "align_seconds": round(self.alignment.seconds, 6),
            "extraction": recipe.extract.name,
            "extract_thresholds": recipe.extract.words(),
            "filtered": recipe.least,
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
            for call, (reduced, kept) in zip(recipe.methods(), found, strict=True)
        ]


def follow(recipe: Recipe, log: Log, before: Outcome | None, tell: Tell) -> Outcome:
    """Align, extract, reduce and measure; what is as it was `before`, on this log, is not repeated.

    Raises
    ------
    ValueError
        Where a function refuses its thresholds or the log, or no scan gives a segment.
    """
    if before is not None and before.recipe.align == recipe.align:
        found = before.alignment
    else:
        before = None
        tell(f"aligning {len(log)} scans by {recipe.align.name}")
        found = recipe.align.run(log)
    map = _built(recipe, log, found, before, tell)
    known = before.known() if before is not None and map is before.map else []
    reductions = [_reduced(call, map, known, tell) for call in recipe.methods()]
    tell("measuring quality")
    return Outcome(recipe, found, map, reductions, [quality(map, each) for each in reductions])


def _built(
    recipe: Recipe, log: Log, found: Alignment, before: Outcome | None, tell: Tell
) -> SegmentMap:
    if before is not None:
        was = before.recipe
        if (was.extract, was.least) == (recipe.extract, recipe.least):
            return before.map
    tell(f"extracting segments by {recipe.extract.name}")
    extract, thresholds = recipe.extract.function, recipe.extract.thresholds
    whole = extraction.build_map(
        log, found.trusted, extract=extract, keep_points=True, **thresholds
    )
    map = whole.filtered(recipe.least) if recipe.least else whole
    if not len(map):
        raise ValueError("no segment is left: loosen the extraction or the filter")
    return map


def _reduced(
    call: Call, map: SegmentMap, known: Iterable[tuple[Call, Reduction]], tell: Tell
) -> Reduction:
    for was, reduced in known:
        if was == call:
            return reduced
    tell(f"reducing {len(map)} segments by {call.name}")
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
