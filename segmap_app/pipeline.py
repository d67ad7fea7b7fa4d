"""From a log to a map: choices, what follows from them step by step, and the same as Python."""

from __future__ import annotations

import copy
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, TypeVar

from segmap import alignment, arrays, extraction, metrics, reduction, warm
from segmap.alignment import Alignment, LiveGraph, Verdict
from segmap.arrays import declared
from segmap.exports import Frame
from segmap.files import escape
from segmap.progress import Stopped, announce
from segmap.quadtree import QuadtreeMap, extent, without_passers
from segmap.reduction import Reduction
from segmap.scans import Log
from segmap.scans.causes import Cause, Finding
from segmap.segments import SegmentMap, main_direction
from segmap.threads import computed

from .call import Call, as_read, defaults, keywords, option_words, shortest, source_of, with_imports
from .files import Session, placed_at

Map = TypeVar("Map", SegmentMap, QuadtreeMap)
Found = TypeVar("Found")
#: Of so many scans a map is kept where the work is stopped.
LEAST_SCANS = 2
#: The options of `segmap map` that name a function, and how those of its thresholds begin.
BEGIN = {"align": "align_", "extract": "extract_", "method": "", "second": "second_"}


class Placing(str):
    """Words on the scans of a log that are placed so far, and the graph that places them."""

    log: Log
    graph: LiveGraph


#: How segments are extracted where nothing else is chosen.
POLYLINES = Call("extract_polylines", extraction.extract_polylines)


@dataclass(frozen=True)
class MapChoices:
    """All choices between a log and its maps: `log` is the expression that gives it.

    `least` is the length of the filter, `seen_through` the share of `without_passers`; `prepare`
    has the options for `alignment.prepared` as a `Session` keeps them, None leaves the log as it
    is; `edits` are those of a `Session`.
    """

    align: Call
    extract: Call = POLYLINES
    least: float = 0.0
    methods: Sequence[Call] = ()
    prepare: Mapping[str, Any] | None = field(default_factory=dict)
    seen_through: float | None = None
    edits: Mapping[str, Any] = field(default_factory=dict)
    log: str = "log"

    def keeps_points(self) -> bool:
        """Whether a method needs the points behind the segments, or the places of the sensor."""
        methods = [reduction.METHODS[call.name] for call in self.methods]
        return any(method.needs_points or method.needs_sensors for method in methods)

    def mends(self) -> tuple[list[tuple[int, ...]], list[tuple[int, ...]]]:
        """Loops that are left out and loops that are forced, by their scans."""
        veto, tie = (
            [tuple(map(int, loop.split("-"))) for loop in self.edits.get(name, [])]
            for name in ("veto", "tie")
        )
        return (veto, tie) if self.align.name == "pose_graph" else ([], [])

    def session(self, log: Log, runs: Sequence[Mapping[str, Any]]) -> Session:
        """The choices by the options of `segmap map`, with a log, as it was read, and its runs."""
        calls = [self.align, self.extract, *self.methods]
        usual = {"extract": "extract_polylines"}
        settings: dict[str, Any] = {"method": "none"}
        for (kind, begin), call in zip(BEGIN.items(), calls, strict=False):
            if call.name != usual.get(kind):
                settings[kind] = call.name
            rules, usual_values = declared(call.function), defaults(call.function)
            for name, value in call.thresholds.items():
                if value != usual_values[name]:
                    settings[begin + name] = as_read(rules[name], value)
        numbers = {"filter": self.least, "seen_through": self.seen_through}
        settings |= {name: value for name, value in numbers.items() if value}
        settings |= self.prepare or {}
        return Session(log, settings, runs, self.edits)

    def code(self) -> str:
        """The calls that make the same, to be copied: `full`, `reduced` and `other`."""
        extract, thresholds = self.extract, self.extract.arguments()
        if extract.name != "extract_polylines":
            thresholds = f", extract=segmap.extraction.{extract.name}{thresholds}"
        suffix = f".filtered({shortest(self.least)})" if self.least else ""
        if "crop" in self.edits:
            suffix = f".cropped({', '.join(map(shortest, self.edits['crop']))}){suffix}"
        lines = [f"log = {self.log}"]
        if self.prepare is not None:
            options = "".join(f", {k}={v!r}" for k, v in keywords(self.prepare).items())
            lines.append(f"log = segmap.alignment.prepared(log{options})")
        if any(self.mends()):
            veto, tie = self.mends()
            graph = f"segmap.alignment.LiveGraph({self.align.arguments().removeprefix(', ')})"
            lines += [f"graph = {graph}", "graph.extend(log)", "graph.refine()"]
            lines.append(f"alignment = graph.with_loops({veto=}, {tie=})")
        else:
            lines.append(f"alignment = {source_of(alignment, 'alignment', self.align, 'log')}")
        if "square" in self.edits:
            turn = "segmap.segments.main_direction(segmap.build_map(log, alignment.trusted))"
            lines.append(f"alignment = alignment.turned(-{turn})")
        if (seen_through := self.seen_through) is not None:
            seen = f"segmap.quadtree.without_passers(log, alignment.trusted, {seen_through=})"
            lines.append(f"log = {seen}")
        thresholds += ", keep_points=True" * self.keeps_points()
        lines.append(f"full = segmap.build_map(log, alignment.trusted{thresholds}){suffix}")
        for name, call in zip(("reduced", "other"), self.methods, strict=False):
            lines.append(f"{name} = {source_of(reduction, 'reduction', call, 'full')}")
        lines.append("segmap.reduction_rate(full, reduced), segmap.quality(full, reduced)")
        name, world = "map.svg", ""
        if "place" in self.edits:
            of, placed = type(frame := world_of(self.edits)), vars(frame)
            options = Call(of.__name__, of, placed).arguments().removeprefix(", ")
            name, world = "map.geojson", f", world=segmap_app.files.{of.__name__}({options})"
        lines.append(f'# segmap.exports.write_segments("{name}", reduced{world})')
        body = "\n".join(lines)
        return with_imports(body)


Choice = Callable[[MapChoices], Any]
#: The steps of a pipeline, in their order, and the choice that each hangs on beside those before.
STEPS: list[tuple[computed[Any], Choice]] = []


def step(choice: Choice) -> Callable[[Callable[[Pipeline], Found]], computed[Found]]:
    """The next step: it is done once, and anew where this choice, or one before it, is another."""

    def add_step(work: Callable[[Pipeline], Found]) -> computed[Found]:
        attribute = computed(work)
        STEPS.append((attribute, choice))
        return attribute

    return add_step


class Pipeline:
    """What follows from a recipe and a log; each step is done where it is asked for first.

    Steps whose choices equal those of `before`, on the same log, are reused. `given` is the log as
    it was read, `log` the one that is aligned; `live_graph` a pose graph before a user's edits, and
    its alignment; `alignment_in_log_frame` the alignment before it is turned; `map` the map before
    its reduction. `stopped` says that only the first scans were aligned, which then are the log.
    """

    def __init__(self, recipe: MapChoices, log: Log, before: Pipeline | None = None) -> None:
        self.recipe, self.given, self.stopped = recipe, log, ""
        self._known: list[tuple[Call, Reduction, float]] = []
        if before is not None and recipe.prepare == before.recipe.prepare:
            self.given, self.stopped = before.given, before.stopped
            for attribute, choice in STEPS:
                if choice(recipe) != choice(before.recipe):
                    return
                if (name := attribute.func.__name__) in vars(before):
                    setattr(self, name, getattr(before, name))
            self._known = before.results() if before.is_reduced() else before._known

    def __getstate__(self) -> dict[str, Any]:
        """What another process is sent: a graph may take hundreds of megabytes."""
        return {k: v for k, v in vars(self).items() if k != "live_graph"} | {"_known": []}

    def is_reduced(self) -> bool:
        """Whether all is done."""
        return "qualities" in vars(self)

    def dispatch(self) -> None:
        """Load, or compile, what all steps need, before one of them is timed."""
        names = [f"alignment {self.recipe.align.name}", "alignment pose_graph"]
        names += ["extraction extract_polylines", f"extraction {self.recipe.extract.name}"]
        names += [f"reduction {call.name}" for call in self.recipe.methods]
        names += ["metrics all"] + ["quadtree all"] * (self.recipe.seen_through is not None)
        warm.dispatch(names)

    @step(lambda recipe: recipe.prepare)
    def log(self) -> Log:
        """With its beams and its odometry put right."""
        self.dispatch()
        if self.recipe.prepare is None:
            return self.given
        announce(0.0, f"preparing {len(self.given)} scans")
        return alignment.prepared(self.given, **keywords(self.recipe.prepare))

    @step(lambda recipe: recipe.align)
    def live_graph(self) -> tuple[LiveGraph, Alignment] | None:
        """Align the log by a pose graph, scan by scan; None for another method."""
        announce(0.0, f"aligning {len(self.log)} scans by {self.recipe.align.name}")
        if self.recipe.align.name != "pose_graph":
            return None
        graph, count = LiveGraph(**self.recipe.align.thresholds), len(self.log)
        for k, scan in enumerate(self.log):
            words = Placing(f"placing scan {k + 1} of {count}")
            words.log, words.graph = self.log, graph
            try:
                announce(k / count, words)
                graph.add(scan)
            except Stopped:
                if k < LEAST_SCANS:
                    raise
                self._cut(k)
                break
        return graph, self._with_causes(graph.refine())

    def _cut(self, count: int) -> None:
        """Keep only the first `count` scans, and note this wherever the map is shown."""
        self.stopped = f"stopped at scan {count} of {len(self.log)}"
        finding = Finding(Cause.OTHER, count, self.stopped, doubtful=True)
        both = (self.given, self.log)
        cut = (replace(each[:count], causes=(*each.causes, finding)) for each in both)
        self.given, self.log = cut

    @step(MapChoices.mends)
    def alignment_in_log_frame(self) -> Alignment:
        """The poses, loops mended."""
        if self.live_graph is None:
            return self.recipe.align.run(self.log)
        if not any(self.recipe.mends()):
            return self.live_graph[1]
        announce(0.0, "mending the graph")
        return self._with_causes(copy.deepcopy(self.live_graph[0]).with_loops(*self.recipe.mends()))

    def _with_causes(self, alignment: Alignment) -> Alignment:
        """With what was found in the log: a graph that grows scan by scan knows no log."""
        return replace(alignment, causes=(*self.log.causes, *alignment.causes))

    @step(lambda recipe: recipe.edits.get("square"))
    def turn(self) -> float:
        """By which most walls run along x and y, radians; 0 where that is not asked for."""
        if not self.recipe.edits.get("square"):
            return 0.0
        return -main_direction(extraction.build_map(self.log, self.alignment_in_log_frame.trusted))

    @step(lambda recipe: recipe.edits.get("square"))
    def alignment(self) -> Alignment:
        """The poses in the frame of the map."""
        unturned = self.alignment_in_log_frame
        return unturned.turned(self.turn) if self.turn else unturned

    @step(lambda recipe: recipe.seen_through)
    def log_without_passers(self) -> Log:
        """Without people who walked through."""
        share, poses = self.recipe.seen_through, self.alignment.trusted
        return self.log if share is None else without_passers(self.log, poses, seen_through=share)

    @step(lambda recipe: (recipe.extract, recipe.keeps_points()))
    def extracted(self) -> SegmentMap:
        """All segments."""
        log, poses, extract = self.log_without_passers, self.alignment.trusted, self.recipe.extract
        thresholds = {**extract.thresholds, "keep_points": self.recipe.keeps_points()}
        announce(0.0, f"extracting segments by {extract.name}")
        return extraction.build_map(log, poses, extract=extract.function, **thresholds)

    @step(lambda recipe: (recipe.extract, recipe.keeps_points()))
    def verdict(self) -> Verdict:
        """Whether that is a map."""
        return self.alignment.verdict_on(self.extracted)

    @step(lambda recipe: recipe.edits.get("crop"))
    def cropped(self) -> SegmentMap:
        """What lies in the rectangle."""
        return cropped(self.extracted, self.recipe.edits.get("crop"))

    @step(lambda recipe: recipe.least)
    def map(self) -> SegmentMap:
        """What is long enough."""
        return self.cropped.filtered(self.recipe.least) if self.recipe.least else self.cropped

    @computed
    def reductions(self) -> list[Reduction]:
        """By each method."""
        reductions = []
        self.dispatch()  # of an outcome before this one the steps before may be known
        for call in self.recipe.methods:
            earlier = [reduced for was, reduced, _ in self._known if was == call]
            if not earlier:
                announce(0.0, f"reducing {len(self.map)} segments by {call.name}")
                earlier = [arrays.instance(call.run(self.map), call.name, Reduction)]
            reductions.append(earlier[0])
        return reductions

    @computed
    def qualities(self) -> list[float]:
        """Of each reduction."""
        reductions = self.reductions
        announce(0.0, "measuring quality")
        return [metrics.quality(self.map, reduced) for reduced in reductions]

    def results(self) -> list[tuple[Call, Reduction, float]]:
        """Each method with its reduction and its quality."""
        return list(zip(self.recipe.methods, self.reductions, self.qualities, strict=True))

    def code(self) -> str:
        """The calls that make the same, to be copied."""
        log, mark, more = self.recipe.log.partition("  #")
        cut = f"[:{len(self.given)}]" if self.stopped else ""
        return replace(self.recipe, log=f"{log}{cut}{mark}{more}").code()

    def summary(self) -> str:
        """What each method leaves, and its quality."""
        return ", ".join(
            f"{call.name} leaves {len(reduced)} of {len(self.map)} segments, quality {quality:.1%}"
            for call, reduced, quality in self.results()
        )

    def rows(self, name: str) -> list[dict[str, Any]]:
        """A row for each method, with the columns of `experiments.sweep`, and the way to the map.

        The log is called by its `name`.
        """
        recipe, edits = self.recipe, self.recipe.edits
        mends = (f"; {k} {', '.join(edits[k])}" for k in ("veto", "tie") if k in edits)
        mended = "".join(mends) + (f"; {self.stopped}" if self.stopped else "")
        way = {
            "map": escape(name),
            "alignment": recipe.align.name,
            "align_thresholds": " ".join(
                [*map(option_words, (recipe.prepare or {}).items()), recipe.align.words() + mended]
            ),
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
                "reduction": round(metrics.reduction_rate(self.map, reduced), 9),
                "quality": round(quality, 9),
                "seconds": round(reduced.seconds, 6),
            }
            for call, reduced, quality in self.results()
        ]


def begin(recipe: MapChoices, log: Log, before: Pipeline | None = None) -> Pipeline:
    """The map and its verdict, done here and now; not its reductions.

    Raises
    ------
    ValueError
        Where a function refuses its thresholds or the log, or no segment is left.
    """
    world_of(recipe.edits)  # a wrong place is refused now, and not where the map is written
    outcome = Pipeline(recipe, log, before)
    verdict = outcome.verdict  # before the map, of which it may say why nothing is left
    if not len(outcome.map):
        raise ValueError(f"{verdict}; no segment is left: loosen extraction, filter or crop")
    return outcome


def follow(recipe: MapChoices, log: Log, before: Pipeline | None = None) -> Pipeline:
    """All that follows, as `begin`."""
    (outcome := begin(recipe, log, before)).results()
    return outcome


def cropped(map: Map, corners: Sequence[float] | None) -> Map:
    """What of a map lies in a rectangle, left, low, right, high; all of it where there is none."""
    if corners is None:
        return map
    part = map.cropped(*corners)
    if isinstance(part, QuadtreeMap):
        assert isinstance(map, QuadtreeMap)
        what, count = "square", int((part.leaves().occ > 0).sum())
        x_min, y_min, x_max, y_max = extent(map, margin=0)
    else:
        what, count = "segment", len(part)
        ends: arrays.Array = map.segments.reshape(-1, 2)
        x_min, y_min, x_max, y_max = (*ends.min(0), *ends.max(0)) if len(map) else (0.0,) * 4
    if not count and (x_min, y_min) != (x_max, y_max):  # of an empty map nothing was cut off
        reach = f"x {x_min:.2f} to {x_max:.2f} m, y {y_min:.2f} to {y_max:.2f} m"
        raise ValueError(f"crop: no {what} lies in that rectangle; the map reaches from {reach}")
    return part


def world_of(edits: Mapping[str, Any]) -> Frame:
    """Where a map lies on the earth that is edited so."""
    place, (north,) = edits.get("place"), edits.get("north", [None])
    if place is None and {"north", "crs"} & {*edits}:
        raise ValueError("north and a grid need a place: the one of (0, 0) of the map")
    return placed_at(place, north, edits.get("crs"))
