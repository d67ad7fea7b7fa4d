"""Options that several commands have, each a field: how logs are read, prepared, judged, placed."""

# No `annotations` of `__future__`: cyclopts reads fields that a class of another module inherits.
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar

from cyclopts import Group, Parameter

from segmap.alignment import METHODS
from segmap.segments import SegmentMap

from ...call import directions
from ...pipeline import world_of
from .._output import Usage
from ._program import checked, files, method, option

T = TypeVar("T")
#: A field that a command does not ask for: it has its default.
Unasked = Annotated[T, Parameter(parse=False)]
#: A file that is named.
File = Annotated[T, Parameter(metavar="FILE")]
#: The logs of a command.
Logs = Annotated[
    str,
    Parameter(
        name="LOG",
        required=True,
        help="A file, a folder, a session (.segmap) with its options, or malaga, clinic, "
        "corridor, room.",
    ),
]
#: How scans are aligned.
Align = Annotated[str | None, method(METHODS, "default: pose_graph")]


def _workers(word: str) -> None:
    if not (word.isdecimal() and int(word)) and "://" not in word:
        raise ValueError(f"{word!r} must be a number, or like tcp://HOST:8786")


def _directions(word: str) -> None:
    directions([word])


def _share(word: str) -> float | str:
    if word != "good" and not 0 <= float(word) <= 1:
        raise ValueError(f"{word} must be from 0 to 1")
    return word if word == "good" else float(word)


@Parameter(name="*", group=Group("reading and printing"))
@dataclass(frozen=True, kw_only=True)
class Reading:
    """How logs are read, and what is told of them.

    Parameters
    ----------
    skip
        Leave damaged lines out, and say how many.
    json
        Print all that is said as JSON, one object a log.
    quiet
        Print no result: only what fails or is doubtful.
    table
        Write the figures as .csv too, a row for each log.
    workers
        One log a process, N at a time, or on the Dask cluster at tcp://HOST:PORT; logs that
        --table holds already are not done again.
    config
        A .toml with options by their names, `filter = 0.5`; those given here win.
    columns
        Of a table, its columns from the left: time_ms,angle_deg,range_mm,-; where a row is a
        scan: time_s,ranges_m.
    view
        Of a table with a scan a row, where its first and its last range point, in degrees.
    scan_topic
        Of a bag, its scans; given twice, those of both; default: scan, or the fullest.
    odometry
        The odometry from a file of poses (.csv, .txt, .tum), by their times; or a topic of the
        bag.
    truth
        The true poses, so too.
    """

    skip: bool = False
    json: bool = False
    quiet: Annotated[bool, Parameter(alias="-q")] = False
    table: Annotated[str | None, files(".csv")] = None
    workers: Annotated[str | None, checked(_workers, "N|ADDRESS")] = None
    config: File[Path | None] = None
    columns: Annotated[str | None, Parameter(metavar="NAMES", allow_leading_hyphen=True)] = None
    view: Annotated[tuple[float, float] | None, Parameter(metavar="FIRST LAST")] = None
    scan_topic: Annotated[tuple[str, ...], Parameter(metavar="TOPIC")] = ()
    odometry: File[str | None] = None
    truth: File[str | None] = None


@Parameter(name="*", group=Group("the laser and its log"))
@dataclass(frozen=True, kw_only=True)
class Laser:
    """The options for `alignment.prepared`.

    Parameters
    ----------
    no_deskew
        Take all beams of a scan to be measured at once, even where the log has their times.
    keep_body
        Keep beams that see the robot itself.
    mask
        Leave out what the laser sees from one direction to another, degrees counter-clockwise
        from where it looks: the robot's own posts; -170:-150,150:170 are two.
    clockwise
        The laser counts its beams clockwise, or hangs upside down, and the log does not say.
    mount
        Where the laser sits on the robot, metres ahead and to the left, and where it looks,
        counter-clockwise from ahead; `--mount auto` takes what turns and ways tell.
    """

    no_deskew: bool = False
    keep_body: bool = False
    mask: Annotated[
        tuple[str, ...], checked(_directions, "FROM:TO", allow_leading_hyphen=True)
    ] = ()
    clockwise: bool = False
    mount: Annotated[
        tuple[float, float, float] | Literal["auto"] | None,
        Parameter(metavar="X Y DEGREES", show_choices=False),
    ] = None

    def options(self) -> dict[str, Any]:
        """What is said, as a session keeps it."""
        options = {name: value for name, value in vars(self).items() if value}
        if self.mount == "auto":
            options |= {"mount_auto": bool(options.pop("mount"))}
        return options


#: A log is taken as it was read.
AS_IT_IS = Laser(no_deskew=True)


@Parameter(name="*", group=Group("what counts as a map"))
@dataclass(frozen=True, kw_only=True)
class Demand:
    """What counts as a map, and what happens where there is none.

    Parameters
    ----------
    strict
        End with 3 too where a smaller share of the scans is placed, 0.9 say; alone, where the map
        is not good.
    force
        Write the files even where that ends with 3.
    """

    strict: Annotated[float | Literal["good"], option(_share, "SHARE", show_choices=False)] = 0.0
    force: bool = False

    def share(self) -> float:
        """At least so many of the scans must be placed."""
        return 0.0 if self.strict == "good" else self.strict


@Parameter(name="*", group=Group("where the map lies"))
@dataclass(frozen=True, kw_only=True)
class World:
    """How a map is turned and cropped, and where on the earth it lies.

    Parameters
    ----------
    crop
        Keep what lies in this rectangle, metres, of the map that is written.
    square
        Turn the map about its origin, by the smallest angle, until most walls run along x and y;
        all files then have this frame.
    place
        Where (0, 0) of the map lies, degrees of WGS84: a .geojson is then in degrees, the other
        files stay in metres.
    north
        Where north is in the map, and in the squared one with --square: counter-clockwise from x;
        default: 90, y points north.
    crs
        A grid in metres, as EPSG:25832: --place is then EAST NORTH in it, and a .geojson names it.
    """

    crop: Annotated[
        tuple[float, float, float, float] | None, Parameter(metavar="LEFT LOW RIGHT HIGH")
    ] = None
    square: bool = False
    place: Annotated[tuple[float, float] | None, Parameter(metavar="LAT LON")] = None
    north: Annotated[tuple[float] | None, Parameter(metavar="DEGREES")] = None
    crs: Annotated[str | None, Parameter(metavar="EPSG:CODE")] = None


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class LogOptions:
    """The options of a command with logs; one that asks for more names it anew.

    `words` is the line that says all this.
    """

    words: Unasked[tuple[str, ...]] = ()
    output: Unasked[tuple[str, ...]] = ()
    align: Unasked[str | None] = None
    loops: Unasked[str | None] = None
    laser: Unasked[Laser] = AS_IT_IS
    demand: Unasked[Demand] = Demand()
    world: Unasked[World] = World()
    reading: Reading = Reading()

    def edits(self) -> dict[str, Any]:
        """What is changed in the map, and not in the way to it."""
        return {name: value for name, value in vars(self.world).items() if value}

    def check(self) -> None:
        """End with an error of usage, before any work, where options do not go together."""
        try:
            world_of(self.edits())
            SegmentMap([]).cropped(*self.world.crop or (0, 0, 1, 1))
        except ValueError as error:
            raise Usage(str(error)) from error


@dataclass(frozen=True, kw_only=True)
class PosedOptions(LogOptions):
    """Those of a command that seeks a pose for each scan."""

    align: Align = None
    laser: Laser = Laser()
    demand: Demand = Demand()


@dataclass(frozen=True, kw_only=True)
class PlacedOptions(PosedOptions):
    """Those of a command that writes maps."""

    world: World = World()
