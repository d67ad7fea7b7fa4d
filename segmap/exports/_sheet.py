"""A map of segments on a sheet of paper, at a scale that a ruler reads."""

from __future__ import annotations

import io
import textwrap
import warnings
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import arrays
from ..arrays import Array, Segments, checked
from ..files import shown, write_bytes
from ..plan import FloorPlan, Room, shapely_or_hint
from ..poses import transform
from ..segments import length, point_distance
from ._world import Direction

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Shorter side of A4, millimetres.
A4_SHORT_MM = 210.0
#: Longer side of A4, millimetres.
A4_LONG_MM = 297.0
#: Margins of the sheet, millimetres.
SHEET_MARGIN_MM = 12.0
#: The band of words below the map, millimetres.
WORDS_BAND_MM = 30.0
#: An inch, millimetres.
INCH_MM = 25.4
#: Scales, the 100 of 1 : 100, and bars are one of these times a power of ten.
ROUND_MANTISSAS = (1, 2, 2.5, 5, 10)
#: The smallest scale: 1 : 20.
SMALLEST_SCALE = 20.0
#: Length of a bar at least, millimetres.
BAR = 25.0
#: Width of walls, millimetres.
WALL_MM = 0.35
#: Letters of a line of words.
LETTERS_PER_LINE = 95
#: Height of a line of words, millimetres.
LINE_MM = 4.0
#: What a plan is in doubt about stands below in smaller letters, points.
DOUBT_POINTS = 6.5
#: Of these, letters of a line.
DOUBT_LETTERS_PER_LINE = 120
#: And lines, at most.
MOST_DOUBT_LINES = 5
#: Dots an inch of a picture.
SHEET_DPI = 200
#: Letters of the words on rooms, points: in small rooms, and in large ones.
LETTERS_POINTS = (3.5, 8.0)
#: Bodies of walls that are nearer to each other than twice this meet in a corner, metres.
BODIES_MEET_M = 0.06
#: What walls are filled with.
WALL_COLOR = "0.35"
#: What rooms are filled with.
ROOM_TINT = "#dde8f3"
#: What doors are drawn in.
DOOR_COLOR = "#c0392b"
ENDS = (".pdf", ".svg", ".png")


@checked
def write_sheet(
    path: str | Path,
    map: Segments,
    *,
    title: str = "",
    verdict: str = "",
    date: str = "",
    north: Direction | None = None,
    plan: FloorPlan | None = None,
    as_recorded: bool = False,
) -> None:
    """Write a sheet to print: the map at a round scale, its bar, north, title, date and verdict.

    Of A4, upright or lying as the map is: printed in its true size, 1 : 100 shows a metre as a
    centimetre.

    Parameters
    ----------
    path : str or Path
        Ends in `.pdf`, `.svg` or `.png`.
    map : SegmentMap, Reduction or (n, 2, 2) array
        Metres.
    title, verdict, date : str
        What the sheet says: `alignment.verdict_on(map).words` tells how far it can be trusted.
    north : float, radians
        Where north is in the map, counter-clockwise from x; by default the sheet shows y instead.
    plan
        Its rooms are tinted, with names, areas and sides, and its doors have their widths; what it
        is in doubt about stands below the verdict.
    as_recorded
        Whether a plan stands as the map does, and not square to the building.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "room.svg"
    ...     write_sheet(path, [[(0, 0), (4, 0)], [(4, 0), (4, 3)]], title="room")
    ...     text = path.read_text(encoding="utf-8")
    >>> "1 : 20" in text, "room" in text
    (True, True)
    """
    place, segments = arrays.file(path), arrays.segments(map, "map")
    end = place.suffix.lower()
    if end not in ENDS:
        raise ValueError(f"path: the name must end in {', '.join(ENDS)}, got {place.name!r}")
    words = checked_words(title, verdict, date)
    if plan is not None:
        arrays.instance(plan, "plan", FloorPlan)
    import matplotlib

    rules: Any = {"svg.fonttype": "none", "svg.hashsalt": "segmap", "pdf.fonttype": 42}
    with matplotlib.rc_context(rules), warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing")  # a letter that no font here has
        turn = 0.0
        if plan is not None and len(plan.axes) and not as_recorded:
            turn = -float((plan.axes[0] + np.pi / 4) % (np.pi / 2) - np.pi / 4)
        figure = _draw_sheet(segments, words, north, plan, turn)
        kept, dated = io.BytesIO(), {".pdf": "CreationDate", ".svg": "Date"}
        metadata = {dated[end]: None} if end in dated else {}
        figure.savefig(kept, format=end[1:], dpi=SHEET_DPI, metadata=metadata)
    write_bytes(place, kept.getvalue())


def checked_words(title: str, verdict: str, date: str) -> list[str]:
    """What a sheet says, as it can be shown."""
    for name, text in {"title": title, "verdict": verdict, "date": date}.items():
        if "\0" in arrays.instance(text, name, str):
            raise ValueError(f"{name} has a NUL character, got {text!r}")
    return [shown(text) for text in (title, verdict, date)]


def rounded_up(least: float) -> float:
    """The next of 1, 2, 2.5 and 5 times a power of ten.

    Examples
    --------
    >>> rounded_up(60.0), rounded_up(0.11), rounded_up(200.0)
    (100.0, 0.2, 200.0)
    """
    ten = 10.0 ** np.floor(np.log10(least))
    return float(next(k * ten for k in ROUND_MANTISSAS if k * ten >= least * (1 - 1e-9)))


def _draw_sheet(
    segments: Array, words: list[str], north: float | None, plan: FloorPlan | None, turn: float
) -> Figure:
    from matplotlib.collections import LineCollection
    from matplotlib.figure import Figure

    rooms = [] if plan is None else [room.outline for room in plan.rooms]
    ends = np.concatenate([segments.reshape(-1, 2), *rooms])
    ends = transform((0.0, 0.0, turn), ends if len(ends) else np.zeros((1, 2)))
    low, high = ends.min(0), ends.max(0)
    wide, tall = high - low
    page = np.array([A4_LONG_MM, A4_SHORT_MM] if wide > tall else [A4_SHORT_MM, A4_LONG_MM])
    room = page - [2 * SHEET_MARGIN_MM, 2 * SHEET_MARGIN_MM + WORDS_BAND_MM]
    scale = rounded_up(max(SMALLEST_SCALE, 1000 * wide / room[0], 1000 * tall / room[1]))
    figure = Figure(tuple(page / INCH_MM))
    ax = figure.add_axes((0, 0, 1, 1))  # millimetres of the paper
    ax.set(xlim=(0, page[0]), ylim=(0, page[1]))
    ax.set_axis_off()
    middle = np.array([page[0] / 2, SHEET_MARGIN_MM + WORDS_BAND_MM + room[1] / 2])

    def on_paper(points: Array) -> Array:
        turned = transform((0.0, 0.0, turn), points)
        return np.asarray((turned - (low + high) / 2) * 1000 / scale + middle)

    placed = on_paper(segments)
    dot = 72 / INCH_MM  # points a millimetre
    if plan is not None:
        _draw_rooms(ax, plan, on_paper, scale)
    ax.add_collection(LineCollection(list(placed), colors="black", linewidths=WALL_MM * dot))
    title, verdict, date = words
    plain: dict[str, Any] = {"parse_math": False, "va": "top"}
    ax.text(
        SHEET_MARGIN_MM,
        SHEET_MARGIN_MM + WORDS_BAND_MM - 6,
        title,
        fontsize=14,
        weight="bold",
        **plain,
    )
    lines, top = textwrap.wrap(verdict, LETTERS_PER_LINE)[:3], SHEET_MARGIN_MM + WORDS_BAND_MM - 14
    ax.text(SHEET_MARGIN_MM, top, "\n".join(lines), fontsize=9, **plain)
    doubts = "" if plan is None or not plan.doubt else f"in doubt: {shown(plan.doubt)}"
    doubts = "\n".join(
        textwrap.wrap(
            doubts, DOUBT_LETTERS_PER_LINE, max_lines=MOST_DOUBT_LINES, placeholder=" ..."
        )
    )
    top -= LINE_MM * len(lines)
    ax.text(SHEET_MARGIN_MM, top, doubts, fontsize=DOUBT_POINTS, **plain)
    right = page[0] - SHEET_MARGIN_MM
    told = "  ".join(filter(None, [f"1 : {scale:g}", date]))
    ax.text(right, SHEET_MARGIN_MM + WORDS_BAND_MM - 6, told, fontsize=11, ha="right", **plain)
    _draw_scale_bar(ax, right, SHEET_MARGIN_MM + 4, scale)
    angle = turn + (np.pi / 2 if north is None else north)
    tip = 9 * np.array([np.cos(angle), np.sin(angle)])
    foot = np.array([right - 10, SHEET_MARGIN_MM + WORDS_BAND_MM + room[1] - 18])
    ax.annotate(
        "", tuple(foot + tip), tuple(foot), arrowprops={"arrowstyle": "-|>", "color": "black"}
    )
    x, y = foot + 1.4 * tip
    ax.text(x, y, "y" if north is None else "N", fontsize=11, ha="center", va="center")
    return figure


def room_sides(plan: FloorPlan, room: Room) -> tuple[float, float]:
    """Length and width of a room along the axes of its building, metres, the longer first."""
    turn = plan.axes[0] if len(plan.axes) else 0.0
    along = room.outline @ [[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]
    width, longer = np.sort(np.ptp(along, axis=0)).tolist()
    return longer, width


def wall_bodies(plan: FloorPlan) -> tuple[list[list[Array]], Array]:
    """Walls whose other face was seen, as rings of corners, and the faces of all others."""
    shapely, known = shapely_or_hint(), np.isfinite(plan.thickness)
    faces, others = plan.walls.segments[known], plan.walls.segments[~known]
    way = (faces[:, 1] - faces[:, 0]) / length(faces)[:, None]
    behind = (plan.side * plan.thickness)[known, None] * np.stack([way[:, 1], -way[:, 0]], -1)
    corners = np.concatenate([faces, (faces + behind[:, None])[:, ::-1]], axis=1)
    whole = shapely.union_all(shapely.polygons(corners))
    for by in (BODIES_MEET_M, -BODIES_MEET_M):  # outer corners are square
        whole = shapely.buffer(whole, by, join_style="mitre")
    parts = [part for part in shapely.get_parts(whole) if not part.is_empty]
    rings = [(part.exterior, *part.interiors) for part in parts]
    return [[np.array(ring.coords)[:-1] for ring in part] for part in rings], others


def _filled(ax: Any, rings: Iterable[Array], color: str) -> None:
    """Fill what lies in the first ring and in no other."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path as Outline

    around = Outline.make_compound_path(*(Outline(ring, closed=False) for ring in rings))
    ax.add_patch(PathPatch(around, facecolor=color, edgecolor="none"))


def _draw_rooms(ax: Any, plan: FloorPlan, on_paper: Callable[[Array], Array], scale: float) -> None:
    """Rooms with their words, clutter, doors with their widths."""
    from matplotlib.collections import LineCollection

    for rings in wall_bodies(plan)[0]:
        _filled(ax, map(on_paper, rings), WALL_COLOR)
    for room in plan.rooms:
        rings = [room.outline, *room.holes]
        _filled(ax, map(on_paper, rings), ROOM_TINT)
        sides = "{:.2f} x {:.2f} m".format(*room_sides(plan, room))
        lines = [shown(room.name), f"{room.area:.1f} m2", sides]
        border = [np.stack([ring, np.roll(ring, -1, axis=0)], 1) for ring in rings]
        circle = 2 * point_distance(room.place, np.concatenate(border)).min()
        size = np.clip(1000 * circle / scale / 4, *LETTERS_POINTS)
        ax.text(*on_paper(room.place), "\n".join(lines), fontsize=size, ha="center", va="center",
                parse_math=False)  # fmt: skip
    clutter = list(on_paper(plan.clutter.segments))
    ax.add_collection(LineCollection(clutter, colors="0.6", linewidths=WALL_MM))
    for door in plan.doors:
        ax.plot(*on_paper(door.ends).T, color=DOOR_COLOR, linewidth=4 * WALL_MM)
        size = np.clip(1000 * door.width / scale / 2.5, *LETTERS_POINTS)
        ax.text(*on_paper(door.place), f"{door.width:.2f} m", fontsize=size, color=DOOR_COLOR,
                ha="center", va="bottom")  # fmt: skip


def _draw_scale_bar(ax: Any, right: float, low: float, scale: float) -> None:
    """A bar of a round length, with its words."""
    metres = rounded_up(BAR * scale / 1000)
    size = 1000 * metres / scale
    ax.plot([right - size, right], [low, low], color="black", linewidth=3, solid_capstyle="butt")
    ax.text(right - size, low + 1.5, f"{metres:g} m", fontsize=9)
