"""`segmap map LOG...`: poses, segments, a reduction, how good it is, and whether it is a map.

And `segmap plan LOG...`: a floor plan with rooms, doors and areas.
"""

# No `annotations` of `__future__`: cyclopts reads fields that a class of another module inherits.
import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Group, Parameter, Token

from segmap import exports, extraction, metrics, reduction
from segmap.arrays import Declared, Quantity, declared
from segmap.display import plural
from segmap.files import write_bytes
from segmap.plan.edits import FORMS, read
from segmap.quadtree import without_passers
from segmap.readers import read_text
from segmap.reduction import METHODS, Reduction
from segmap.scans import Log

from .. import files
from ..pipeline import MapChoices, Pipeline, world_of
from ..plans import plan_of, sheet_words
from . import log_options
from ._output import Report, Usage, metres, percent, seconds

#: What is written of a map.
OUTPUT = log_options.output(
    "the map after the reduction; a .png shows it before and after, a .segmap keeps the log with "
    "these options and figures",
    *(".svg", ".csv", ".npz", ".dxf", ".png", ".geojson", ".wkt", ".segmap"),
)
#: What is written of a plan.
PLAN_OUTPUT = log_options.output(
    "the plan: a sheet, layers, geometries, a table of rooms",
    *(".svg", ".pdf", ".png", ".dxf", ".geojson", ".csv"),
)
#: What a person changes of a plan.
EDIT = log_options.checked(
    read,
    "EDIT",
    help=f"What a person changes, by places in metres of the log, once for each: {FORMS}.",
    allow_leading_hyphen=True,
)
#: How segments are extracted, and how they are reduced.
EXTRACT = log_options.method(extraction.METHODS, "default: extract_polylines")
METHOD = log_options.method(METHODS, f"default: {reduction.USUAL_METHOD}", "none")
#: A length that may be 0.
LENGTH = log_options.quantity(Declared(float, Quantity("metres", least=0), (), False), "METRES")
#: The share of beams that end where others went on.
SEEN_THROUGH = log_options.quantity(declared(without_passers)["seen_through"], "SHARE")
#: Where loops of a pose graph are told.
LOOPS = Group("loops of pose_graph")


def pairs(text: str) -> list[str]:
    """Loops as `FIRST-SECOND`: one, or those of a table as `--loops` writes it."""
    if re.fullmatch(r"\d+-\d+", text):
        return [text]
    try:
        lines = read_text(text).splitlines()
        rows = csv.DictReader(lines, delimiter=";" if ";" in "".join(lines[:1]) else ",")
        return [f"{int(row['first'])}-{int(row['second'])}" for row in rows]
    except (KeyError, TypeError, ValueError) as error:
        raise ValueError(f"{text} must be a table with columns first and second") from error


def pairs_of_all(kind: object, tokens: Sequence[Token]) -> tuple[str, ...]:
    """Those of all words of an option."""
    return tuple(pair for token in tokens for pair in pairs(token.value))


#: Loops that are left out, and those that are forced.
VETO = Parameter(metavar="FILE", group=LOOPS, converter=pairs_of_all)
TIE = Parameter(metavar="FIRST-SECOND", group=LOOPS, converter=pairs_of_all)


@dataclass(frozen=True, kw_only=True)
class MakingOptions(log_options.PlacedOptions):
    """All that leads from poses to a map and its files.

    Parameters
    ----------
    filter
        Leave shorter segments out before reducing.
    seen_through
        Leave people out who walked through: beams that end where at most this share of all beams
        ended while the others went on, 0.2 say.
    loops
        Align by pose_graph, and write its loops as .csv: scans, residual, span, places.
    """

    method: Annotated[str, METHOD] = reduction.USUAL_METHOD
    extract: Annotated[str, EXTRACT] = "extract_polylines"
    filter: Annotated[float | None, LENGTH] = None
    seen_through: Annotated[float | None, SEEN_THROUGH] = None
    output: Annotated[tuple[str, ...], OUTPUT] = ()
    loops: Annotated[str | None, Parameter(metavar="FILE", group=LOOPS)] = None


@dataclass(frozen=True, kw_only=True)
class MapOptions(MakingOptions):
    """The options of `segmap map`.

    Parameters
    ----------
    veto
        Align by pose_graph without these loops: the rows of --loops that are false, or one as
        FIRST-SECOND.
    tie
        Align by pose_graph, with a loop between two scans that see one place; or a FILE.
    """

    veto: Annotated[tuple[str, ...], VETO] = ()
    tie: Annotated[tuple[str, ...], TIE] = ()

    def edits(self) -> dict[str, Any]:
        """What is changed in the map, loops too."""
        mends = {"veto": self.veto, "tie": self.tie}
        return {name: loops for name, loops in mends.items() if loops} | super().edits()

    def check(self) -> None:
        """Refuse loops that are of no pose graph."""
        super().check()
        closes_loops = (self.align or "pose_graph").startswith("pose_graph")
        if (self.veto or self.tie or self.loops) and not closes_loops:
            raise Usage(f"--loops, --veto and --tie: {self.align} closes no loops")


@log_options.command(
    "map",
    "map room -o room.svg                a log that comes with segmap",
    "map room corridor -o '{name}.dxf'   a file for each log, for CAD",
    "map malaga --method fusion:tolerance=0.05 -o it.png -o it.segmap",
)
def map_walls(*logs: log_options.Logs, given: MapOptions = MapOptions()) -> int:
    """A map of segments: align, extract, reduce, and tell how good it is.

    Aligns the scans of each log, draws a segment for each wall that a scan saw, merges the
    segments of one wall, and says how good the map is, or that it is none.
    """
    if len(logs) > 1 and (given.veto or given.tie or given.loops):
        raise Usage("--loops, --veto and --tie are for one log")
    return log_options.each_log(logs, given, draw_walls_of_log)


def draw_walls_of_log(given: MapOptions, log: Log, paths: list[Path], report: Report) -> int:
    """Map one log, and write what was asked for where there is a map."""
    for name, loops in (("veto", given.veto), ("tie", given.tie)):
        for loop in loops:
            if max(map(int, loop.split("-"))) >= len(log):
                raise ValueError(f"--{name} {loop}: the log has scans 0 to {len(log) - 1}")
    outcome = log_options.tell_poses(Pipeline(map_recipe_of(given, log), log), report)
    return write_map(given, outcome, outcome.recipe, paths, report)


def map_recipe_of(given: MakingOptions, log: Log) -> MapChoices:
    """All that the options say of a map."""
    chosen = [given.method] if given.method != "none" else []
    return replace(
        log_options.recipe_of(given, log),
        extract=log_options.call_of(given.extract, extraction.METHODS),
        least=given.filter or 0.0,
        methods=[log_options.call_of(name, METHODS) for name in chosen],
        seen_through=given.seen_through,
    )


def write_map(
    given: MakingOptions,
    outcome: Pipeline,
    own_recipe: MapChoices,
    paths: list[Path],
    report: Report,
) -> int:
    """Say how a map comes out, and write it; a session has `own_recipe` and these figures."""
    if given.seen_through is not None:
        pairs = zip(outcome.log, outcome.log_without_passers, strict=True)
        gone = sum(int(a.valid.sum() - b.valid.sum()) for a, b in pairs)
        words = f"{plural(gone, 'beam')} left out that others saw through"
        report.line("passers", words, beams=gone)
    count = len(outcome.extracted)
    report.line("extracted", plural(count, "segment"), segments=count)
    if given.loops is not None:
        write_bytes(Path(given.loops), outcome.alignment.loops().to_csv().encode())
        report.line("loops", f"written to {given.loops}", file=given.loops)
    if given.world.crop is not None:
        count = len(outcome.cropped)
        report.line("cropped", f"to {plural(count, 'segment')}", segments=count)
    if given.filter is not None:
        words = f"{plural(len(outcome.map), 'segment')} of {given.filter:g} m or more"
        report.line("filtered", words, segments=len(outcome.map), least=given.filter)
    for each in outcome.reductions:
        tell_reduction(outcome, each, report)
    after = outcome.reductions[0] if outcome.reductions else outcome.map

    def write(path: Path) -> None:
        """In the format that the name asks for."""
        if path.suffix.lower() == ".png":
            from ._pictures import write_map_picture

            write_map_picture(path, outcome.map, after)
        elif path.suffix.lower() == ".segmap":
            files.write_session(path, own_recipe.session(outcome.given, [report.for_session()]))
        else:
            exports.write_segments(path, after, world=world_of(outcome.recipe.edits))

    return log_options.finish(given.demand, outcome.verdict, paths, report, write)


def tell_reduction(outcome: Pipeline, reduction: Reduction, report: Report) -> None:
    """Say what a reduction leaves, and how good it is."""
    method, rate = outcome.recipe.methods[0].name, metrics.reduction_rate(outcome.map, reduction)
    gone = f"{percent(rate)} gone ({metrics.grade_reduction(rate)})"
    segments = plural(len(reduction), "segment")
    report.line(
        "reduced",
        f"by {method}: {segments} left, {gone}, {seconds(reduction.seconds)}",
        method=method,
        segments=len(reduction),
        rate=rate,
        grade=metrics.grade_reduction(rate),
        seconds=reduction.seconds,
    )
    if reduction.doubt:
        report.line("", f"doubt: {reduction.doubt}")
    if len(outcome.map):
        quality, errors = outcome.qualities[0], metrics.errors(outcome.map, reduction)
        off = f"segments lie {metres(errors.mean())} off on average, {metres(errors.max())} at most"
        report.line(
            "quality",
            f"{percent(quality)} ({metrics.grade_quality(quality)} reduction): {off}",
            quality=quality,
            grade=metrics.grade_quality(quality),
            mean_error=float(errors.mean()),
            largest_error=float(errors.max()),
        )


@dataclass(frozen=True, kw_only=True)
class PlanOptions(log_options.PlacedOptions):
    """The options of `segmap plan`.

    Parameters
    ----------
    as_recorded
        Sheet and DXF stand as the log does, and not square to the building.
    """

    as_recorded: bool = False
    edit: Annotated[tuple[str, ...], EDIT] = ()
    output: Annotated[tuple[str, ...], PLAN_OUTPUT] = ()


@log_options.command(
    "plan",
    "plan room -o room.pdf                 a sheet to print",
    "plan room -o room.dxf -o rooms.csv    layers for CAD, a table of rooms",
    "plan room --as-recorded -o room.pdf   it stands as the log does",
    "plan room --edit 'Name 1 2 hall'      the room at (1, 2) has this name",
)
def draw_plan(*logs: log_options.Logs, given: PlanOptions = PlanOptions()) -> int:
    """A floor plan: walls, rooms with their areas, doors."""
    return log_options.each_log(logs, given, plan_of_log)


def plan_of_log(given: PlanOptions, log: Log, paths: list[Path], report: Report) -> int:
    """Map one log, draw its plan, and write what was asked for where there is a map."""
    outcome = log_options.placed_outcome(given, log, report)
    verdict, edits = outcome.verdict, [read(text) for text in given.edit]
    plan = plan_of(outcome, edits)
    area = sum(room.area for room in plan.rooms)
    rooms, doors = plural(len(plan.rooms), "room"), plural(len(plan.doors), "door")
    hidden = sum(room.hidden for room in plan.rooms)
    words = f"{rooms} of {area:.1f} m2, of which furniture hides {hidden:.1f}; {doors}"
    figures = {"rooms": len(plan.rooms), "area": area, "hidden": hidden, "doors": len(plan.doors)}
    report.line("planned", words, **figures)
    words = f"{plural(len(plan.walls), 'wall')}, {plural(len(plan.clutter), 'piece')} of clutter"
    report.line("walls", words, walls=len(plan.walls), clutter=len(plan.clutter))
    if plan.doubt:
        report.line("doubt", plan.doubt, doubt_of_plan=plan.doubt)

    def write(path: Path) -> None:
        """With the words of a sheet."""
        options: Any = {"world": world_of(outcome.recipe.edits), "as_recorded": given.as_recorded}
        exports.write_plan(path, plan, **sheet_words(outcome), **options)

    return log_options.finish(given.demand, verdict, paths, report, write)
