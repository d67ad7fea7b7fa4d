"""A map of segments on a sheet of paper, at a scale that a ruler reads."""

from __future__ import annotations

import io
import textwrap
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import arrays
from ..arrays import Array, Segments, checked
from ..files import escape, write_bytes
from ..plan import FloorPlan, Room, shapely_or_hint
from ..poses import transform
from ..segments import length
from ._labels import POINTS_PER_LETTER_MM, POINTS_PER_MM, Label, Labels, text_size
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
#: Where the map begins above it, or the list of rooms, millimetres.
WORDS_CORNER_MM = (SHEET_MARGIN_MM, SHEET_MARGIN_MM + WORDS_BAND_MM)
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
#: What a plan is in doubt about, and its source, stand in smaller letters, points.
DOUBT_POINTS = 6.5
#: Of these, letters of a line.
DOUBT_LETTERS_PER_LINE = 120
#: And lines, at most.
MOST_DOUBT_LINES = 5
#: Dots an inch of a picture.
SHEET_DPI = 200
#: Letters of the list of rooms, points.
LIST_POINTS = 6.0
#: From one row of that list to the next, millimetres.
LIST_ROW_MM = 3.2
#: Space beside a column of that list, millimetres.
LIST_MARGIN_MM = 4.0
#: Words stand so far from their door at most, millimetres.
WORDS_REACH_MM = 15.0
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
    source: str = "",
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
    title, verdict, date, source : str
        What the sheet says: `alignment.verdict_on(map).words` tells how far it can be trusted.
    north : float, radians
        Where north is in the map, counter-clockwise from x; no arrow where it is not known.
    plan
        Its rooms are tinted, with names and areas, and stand in a list with their sides and the
        sum; its doors, and openings behind which nothing was seen, have their widths; what it is in
        doubt about stands below the verdict.
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
    words = checked_words(title, verdict, date, source)
    if plan is not None:
        arrays.instance(plan, "plan", FloorPlan)
    import matplotlib

    rules: Any = {"svg.fonttype": "none", "svg.hashsalt": "segmap", "pdf.fonttype": 42}
    with matplotlib.rc_context(rules), warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing")  # a letter that no font here has
        figure = _draw_sheet(segments, words, north, plan, paper_of(segments, plan, as_recorded))
        stream, dated = io.BytesIO(), {".pdf": "CreationDate", ".svg": "Date"}
        metadata = {dated[end]: None} if end in dated else {}
        figure.savefig(stream, format=end[1:], dpi=SHEET_DPI, metadata=metadata)
    write_bytes(place, stream.getvalue())


def checked_words(*words: str) -> list[str]:
    """Title, verdict, date and source of a sheet, as they can be shown."""
    for name, text in zip(("title", "verdict", "date", "source"), words, strict=True):
        if "\0" in arrays.instance(text, name, str):
            raise ValueError(f"{name} has a NUL character, got {text!r}")
    return [*map(escape, words)]


def rounded_up(least: float) -> float:
    """The next of 1, 2, 2.5 and 5 times a power of ten.

    Examples
    --------
    >>> rounded_up(60.0), rounded_up(0.11), rounded_up(200.0)
    (100.0, 0.2, 200.0)
    """
    ten = 10.0 ** np.floor(np.log10(least))
    return float(next(k * ten for k in ROUND_MANTISSAS if k * ten >= least * (1 - 1e-9)))


@dataclass(frozen=True)
class Paper:
    """An A4 sheet, and where a map stands on it.

    Parameters
    ----------
    page : (2,) array
        Its sides, millimetres.
    low, high : (2,) arrays
        Corners of what the map has of it, millimetres.
    middle : (2,) array
        The middle of the map, which stands between them, metres of the turned map.
    turn : float, radians
        The map is turned by this about its origin.
    scale
        The 100 of 1 : 100.
    """

    page: Array
    low: Array
    high: Array
    middle: Array
    turn: float
    scale: float

    def turned(self, points: Array) -> Array:
        """Places of the turned map, metres."""
        return np.asarray(transform((0.0, 0.0, self.turn), points))

    def placed(self, points: Array) -> Array:
        """Places on the paper, millimetres."""
        off = (self.turned(points) - self.middle) * 1000 / self.scale
        return np.asarray(off + (self.low + self.high) / 2)

    def metres(self, places: Array) -> Array:
        """Places of the turned map, metres, by those on the paper."""
        off = (places - (self.low + self.high) / 2) * self.scale / 1000
        return np.asarray(off + self.middle)


def paper_of(segments: Array, plan: FloorPlan | None, as_recorded: bool) -> Paper:
    """The sheet of a map, upright or lying as the map is; a plan is square to its building."""
    turn, rooms = 0.0, [] if plan is None else [room.outline for room in plan.rooms]
    if plan is not None and len(plan.axes) and not as_recorded:
        turn = -float((plan.axes[0] + np.pi / 4) % (np.pi / 2) - np.pi / 4)
    ends = np.concatenate([segments.reshape(-1, 2), *rooms])
    ends = transform((0.0, 0.0, turn), ends if len(ends) else np.zeros((1, 2)))
    sides, middle = np.ptp(ends, axis=0), (ends.min(0) + ends.max(0)) / 2
    page = np.array([A4_LONG_MM, A4_SHORT_MM] if sides[0] > sides[1] else [A4_SHORT_MM, A4_LONG_MM])
    low, high = np.array(WORDS_CORNER_MM), page - SHEET_MARGIN_MM
    if plan is not None and plan.rooms:
        low[1] += _list_of_rooms(plan, (high - low)[0])[0]
    scale = rounded_up(max(SMALLEST_SCALE, *(1000 * sides / (high - low))))
    return Paper(page, low, high, middle, turn, scale)


def _draw_sheet(
    segments: Array, words: list[str], north: float | None, plan: FloorPlan | None, paper: Paper
) -> Figure:
    from matplotlib.collections import LineCollection
    from matplotlib.figure import Figure

    figure = Figure(tuple(paper.page / INCH_MM))
    ax = figure.add_axes((0, 0, 1, 1))  # millimetres of the paper
    ax.set(xlim=(0, paper.page[0]), ylim=(0, paper.page[1]))
    ax.set_axis_off()
    width = WALL_MM * POINTS_PER_MM
    lines = list(paper.placed(segments))
    ax.add_collection(LineCollection(lines, colors="black", linewidths=width))
    if plan is not None:
        _draw_rooms(ax, plan, paper)
        for words_of_list in _list_of_rooms(plan, paper.high[0] - paper.low[0])[1]:
            ax.text(**words_of_list)
    right = paper.high[0]
    _write_words(ax, words, "" if plan is None else plan.doubt, f"1 : {paper.scale:g}", right)
    _draw_scale_bar(ax, right, SHEET_MARGIN_MM + 4, paper.scale)
    if north is not None:
        tip = 9 * np.array([np.cos(paper.turn + north), np.sin(paper.turn + north)])
        foot = paper.high - [10, 18]
        arrow = {"arrowstyle": "-|>", "color": "black"}
        ax.annotate("", tuple(foot + tip), tuple(foot), arrowprops=arrow)
        x, y = foot + 1.4 * tip
        ax.text(x, y, "N", fontsize=11, ha="center", va="center")
    return figure


def _write_words(ax: Any, words: list[str], doubt: str, scale: str, right: float) -> None:
    """The band below the map: title, verdict, what is in doubt, scale, date and source."""
    title, verdict, date, source = words
    plain: dict[str, Any] = {"parse_math": False, "va": "top"}
    left_mm, top_mm = WORDS_CORNER_MM
    ax.text(left_mm, top_mm - 6, title, fontsize=14, weight="bold", **plain)
    lines = textwrap.wrap(verdict, LETTERS_PER_LINE)[:3]
    ax.text(left_mm, top_mm - 14, "\n".join(lines), fontsize=9, **plain)
    doubts = textwrap.wrap(
        f"in doubt: {escape(doubt)}" if doubt else "", DOUBT_LETTERS_PER_LINE,
        max_lines=MOST_DOUBT_LINES, placeholder=" ...",
    )  # fmt: skip
    below_mm = top_mm - 14 - LINE_MM * len(lines)
    ax.text(left_mm, below_mm, "\n".join(doubts), fontsize=DOUBT_POINTS, **plain)
    ax.text(right, top_mm - 6, f"{scale}  {date}".strip(), fontsize=11, ha="right", **plain)
    ax.text(right, top_mm - 11, source, fontsize=DOUBT_POINTS, ha="right", **plain)


def _list_of_rooms(plan: FloorPlan, wide: float) -> tuple[float, list[dict[str, Any]]]:
    """Rooms with their areas and sides, and the sum, in columns: their height, and the words."""
    names = [*(escape(room.name) for room in plan.rooms), "in all"]
    sizes = [room.area for room in plan.rooms]
    areas = [f"{size:.1f} m2" for size in (*sizes, sum(sizes))]
    sides = ["{:.2f} x {:.2f} m".format(*room_sides(plan, room)) for room in plan.rooms]
    entries = names, areas, [*sides, ""]
    name_mm, area_mm, sides_mm = (text_size("\n".join(k), LIST_POINTS)[0] for k in entries)
    column_mm = name_mm + area_mm + sides_mm + 2 * LIST_MARGIN_MM
    per_column = -(-len(names) // max(1, int(wide / column_mm)))
    height_mm, words = LIST_ROW_MM * per_column + LIST_MARGIN_MM, list[dict[str, Any]]()
    for number, (name, area, size) in enumerate(zip(*entries, strict=True)):
        column, row = divmod(number, per_column)
        style = {"fontsize": LIST_POINTS, "va": "top", "parse_math": False}
        style["y"] = WORDS_CORNER_MM[1] + height_mm - LIST_MARGIN_MM - row * LIST_ROW_MM
        left_mm = WORDS_CORNER_MM[0] + column * column_mm
        right_mm = left_mm + name_mm + LIST_MARGIN_MM / 2 + area_mm
        words.append({"x": left_mm, "s": name, **style})
        words.append({"x": right_mm, "s": area, "ha": "right", **style})
        words.append({"x": right_mm + LIST_MARGIN_MM / 2, "s": size, **style})
    return height_mm, words


def room_sides(plan: FloorPlan, room: Room) -> tuple[float, float]:
    """Length and width of a room along the axes of its building, metres, the longer first."""
    turn = plan.axes[0] if len(plan.axes) else 0.0
    along = room.outline @ [[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]
    width, longer = np.sort(np.ptp(along, axis=0)).tolist()
    return longer, width


def wall_bodies(plan: FloorPlan) -> tuple[Any, Array]:
    """Walls whose other face was seen, as polygons of shapely, and the faces of all others."""
    shapely, has_body = shapely_or_hint(), np.isfinite(plan.thickness)
    faces, others = plan.walls.segments[has_body], plan.walls.segments[~has_body]
    way = (faces[:, 1] - faces[:, 0]) / length(faces)[:, None]
    behind = (plan.side * plan.thickness)[has_body, None] * np.stack([way[:, 1], -way[:, 0]], -1)
    corners = np.concatenate([faces, (faces + behind[:, None])[:, ::-1]], axis=1)
    whole = shapely.union_all(shapely.polygons(corners))
    for by in (BODIES_MEET_M, -BODIES_MEET_M, 0.0):  # outer corners are square, and none crosses
        whole = shapely.buffer(whole, by, join_style="mitre")
    parts = shapely.get_parts(whole)
    return parts[~shapely.is_empty(parts)], others


def rings_of(polygon: Any) -> list[Array]:
    """Corners of the outlines of polygons, and of their holes, the first of each not repeated."""
    parts = shapely_or_hint().get_parts(polygon)
    return [np.array(ring.coords)[:-1] for k in parts for ring in (k.exterior, *k.interiors)]


def _filled(ax: Any, polygon: Any, color: str) -> None:
    """Fill a polygon but for its holes."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path as Outline

    around = Outline.make_compound_path(*map(Outline, rings_of(polygon)))
    ax.add_patch(PathPatch(around, facecolor=color, edgecolor="none"))


def _draw_rooms(ax: Any, plan: FloorPlan, paper: Paper) -> None:
    """Rooms with their words, clutter, doors with their widths."""
    from matplotlib.collections import LineCollection

    transform_of = shapely_or_hint().transform
    for polygon in transform_of(wall_bodies(plan)[0], paper.placed):
        _filled(ax, polygon, WALL_COLOR)
    clutter = list(paper.placed(plan.clutter.segments))
    ax.add_collection(LineCollection(clutter, colors="0.6", linewidths=WALL_MM))
    for door in plan.doors:
        ax.plot(*paper.placed(door.ends).T, color=DOOR_COLOR, linewidth=4 * WALL_MM)
    for room in plan.rooms:
        _filled(ax, transform_of(room.polygon, paper.placed), ROOM_TINT)
    for label in labels_of(plan, paper):
        if label.leader is not None:
            ax.plot(*label.leader.T, color=label.color, linewidth=0.4)
        for line, middle in label.lines():
            ax.text(
                *middle, line, fontsize=label.letters * POINTS_PER_LETTER_MM, color=label.color,
                ha="center", va="center", parse_math=False,
            )  # fmt: skip


def labels_of(plan: FloorPlan, paper: Paper) -> list[Label]:
    """Names and areas of rooms, and the widths of doors and openings, where there is room."""
    shapely, page = shapely_or_hint(), shapely_or_hint().box(*paper.low, *paper.high)
    areas = [shapely.transform(room.polygon, paper.placed).buffer(0) for room in plan.rooms]
    bodies = shapely.transform(wall_bodies(plan)[0], paper.placed)
    lines = [*plan.walls.segments, *(door.ends for door in plan.doors)]
    walls = [*shapely.linestrings(paper.placed(np.reshape(lines, (-1, 2, 2))))]
    drawn = shapely.union_all([*walls, *bodies])
    clutter = shapely.multilinestrings(paper.placed(plan.clutter.segments))
    labels, outside = Labels(drawn, drawn | clutter, page), list[tuple[str, Array]]()
    for room, area in zip(plan.rooms, areas, strict=True):
        words = f"{escape(room.name)}\n{room.area:.1f} m2"
        if not labels.place_inside(words, area):
            outside.append((words, paper.placed(room.place)))
    beyond = page.difference(shapely.union_all(areas))
    for words, place in outside:
        labels.place_near(words, place, beyond)
    for door in [*plan.doors, *plan.openings_to_nowhere]:
        place = paper.placed(door.place)
        around = shapely.Point(place).buffer(WORDS_REACH_MM)
        labels.place_near(f"{door.width:.2f} m", place, around, DOOR_COLOR)
    return labels.placed


def _draw_scale_bar(ax: Any, right: float, low: float, scale: float) -> None:
    """A bar of a round length, with its words."""
    metres = rounded_up(BAR * scale / 1000)
    size = 1000 * metres / scale
    ax.plot([right - size, right], [low, low], color="black", linewidth=3, solid_capstyle="butt")
    ax.text(right - size, low + 1.5, f"{metres:g} m", fontsize=9)
