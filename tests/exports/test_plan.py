"""Plans that are written, as other programs read them."""

import csv
import json
import re
from dataclasses import replace

import ezdxf
import numpy as np
import pytest
import shapely
from plan_buildings import rooms_of_squares
from scipy import ndimage

from segmap import build_map, exports, load, plan, quadtree, reduction
from segmap.poses import transform
from segmap.quadtree import FREE, OCCUPIED, UNKNOWN, QuadtreeMap, map_of_grid
from segmap.simulation import polyline


@pytest.fixture(scope="module")
def two_rooms():
    return rooms_of_squares(2.0, 2.9)


def test_a_drawing_has_its_layers(two_rooms, tmp_path):
    """Catches rooms on the layer of walls, an outline that is not closed, a door of another width,
    a drawing that other programs refuse, and one that differs each time."""
    for name in ("it.dxf", "again.dxf"):
        exports.write_plan(tmp_path / name, two_rooms)
    assert (tmp_path / "it.dxf").read_bytes() == (tmp_path / "again.dxf").read_bytes()
    drawing = ezdxf.readfile(tmp_path / "it.dxf")
    by_layer = {}
    for one in drawing.modelspace():
        by_layer.setdefault(one.dxf.layer, []).append(one)
    assert not drawing.audit().errors and drawing.units == 6 and drawing.dxfversion == "AC1024"
    bodies = [one for one in by_layer["WALLS"] if one.dxftype() == "LWPOLYLINE"]
    assert bodies and all(one.is_closed for one in (*bodies, *by_layer["ROOMS"]))
    area = sum(shapely.Polygon(one.get_points("xy")).area for one in bodies)
    assert area == pytest.approx(2 * 0.2 * 1.5, abs=0.1)  # between the rooms, beside the door
    assert len(by_layer["ROOMS"]) == 2
    (door,) = by_layer["DOORS"]
    assert door.dxf.name == "DOOR" and door.dxf.xscale == two_rooms.doors[0].width
    (line,) = door.virtual_entities()
    ends = np.sort([line.dxf.start.y, line.dxf.end.y])
    assert np.allclose(ends, np.sort(two_rooms.doors[0].ends[:, 1]), atol=1e-6)
    words = sorted(one.dxf.text for one in by_layer["TEXT"])  # rooms without the doorway
    width = f"{two_rooms.doors[0].width:.2f} m"
    assert words == [width, "19.6 m2", "19.6 m2", "room 1", "room 2"]


@pytest.mark.parametrize("as_recorded", [False, True])
def test_a_sheet_is_square_to_its_building(tmp_path, as_recorded):
    """Catches a sheet that is turned twice or the wrong way round, and a drawing of which only a
    part is turned."""
    turn = np.radians(20)
    walls = transform((0, 0, turn), polyline([(0, 0), (8, 0), (8, 3), (0, 3)], closed=True))
    tree = QuadtreeMap(resolution=0.05, free_resolution=0.05)
    places = transform((0, 0, turn), [(x, y) for x in np.arange(0.1, 8, 0.1) for y in (0.1, 2.9)])
    for x in np.arange(0.5, 8, 0.5):
        tree.insert_scan(transform((0, 0, turn), [(x, 1.5)])[0], places)
        tree.insert_scan(transform((0, 0, turn), [(x, 1.5)])[0], places)
    jambs = transform((0, 0, turn), [(2.0, 0.0), (3.0, 0.0)]).tolist()
    found = plan.floor_plan(walls, tree, edits=[plan.NewDoor(*map(tuple, jambs))])
    exports.write_plan(tmp_path / "it.svg", found, as_recorded=as_recorded)
    exports.write_plan(tmp_path / "it.dxf", found, as_recorded=as_recorded)
    space = ezdxf.readfile(tmp_path / "it.dxf").modelspace()
    (door,), lines = space.query("INSERT"), [*space.query('LINE[layer=="WALLS"]')]
    ways = [np.degrees((one.dxf.end - one.dxf.start).angle) for one in lines]
    ways = np.array([*ways, door.dxf.rotation]) % 90
    assert np.allclose(np.minimum(ways, 90 - ways), 20 if as_recorded else 0, atol=0.5)
    walls = shapely.multilinestrings([[one.dxf.start.vec2, one.dxf.end.vec2] for one in lines])
    place = shapely.Point(*door.dxf.insert.vec2)
    assert walls.distance(place) == pytest.approx(door.dxf.xscale / 2, abs=0.05)
    text = (tmp_path / "it.svg").read_text(encoding="utf-8")
    found = re.findall(r'<path d="M ([\d.]+) ([\d.]+) \nL ([\d.]+) ([\d.]+) \n"', text)
    x, y = np.diff(np.array(found, float).reshape(-1, 2, 2), axis=1)[:, 0].T
    ways = np.degrees(np.arctan2(y, x))[np.hypot(x, y) > 100] % 90
    *walls, bar = np.minimum(ways, 90 - ways)
    assert len(walls) == 5 and bar < 0.1  # one has the door
    assert np.allclose(walls, 20 if as_recorded else 0, atol=0.5)


def test_geometries_tell_what_they_are(two_rooms, tmp_path):
    """Catches rings that are open or turn the wrong way round, doors without their rooms, and a
    corridor that is tagged as a room."""
    named = two_rooms.edited([plan.Name(tuple(two_rooms.rooms[1].place), "Corridor 1")])
    exports.write_plan(tmp_path / "it.geojson", named)
    features = json.loads((tmp_path / "it.geojson").read_text())["features"]
    kinds = [one["properties"]["kind"] for one in features]
    assert kinds.count("room") == 2 and kinds.count("door") == 1
    tags = {
        (k["kind"], k.get("indoor"), k.get("door")) for k in (f["properties"] for f in features)
    }
    assert tags - {("clutter", None, None)} == {
        ("room", "room", None),
        ("room", "corridor", None),
        ("wall", "wall", None),
        ("door", None, "yes"),
    }
    assert {one["properties"]["level"] for one in features} == {"0"}
    room, door = features[0], features[2]
    ring = np.array(room["geometry"]["coordinates"][0])
    assert (ring[0] == ring[-1]).all()
    x, y = ring.T
    assert (x[:-1] * y[1:] - x[1:] * y[:-1]).sum() / 2 == pytest.approx(19.6, abs=0.1)
    assert door["properties"]["width"] == pytest.approx(0.9, abs=0.11)
    assert door["properties"]["rooms"] == ["room 1", "Corridor 1"]


def test_a_table_has_a_row_for_each_room(two_rooms, tmp_path):
    """Catches sides that are swapped, and a perimeter for an area."""
    exports.write_plan(tmp_path / "it.csv", two_rooms)
    rows = list(csv.DictReader((tmp_path / "it.csv").read_text().splitlines()))
    assert [row["name"] for row in rows] == ["room 1", "room 2"]
    for row in rows:
        sizes = [float(row[name]) for name in ("area_m2", "perimeter_m", "length_m", "width_m")]
        assert sizes == pytest.approx([19.7, 18.0, 5.0, 4.0], abs=0.25) and row["doors"] == "1"


def test_a_sheet_names_rooms_and_doors(two_rooms, tmp_path):
    """Catches a sheet with the walls alone."""
    exports.write_plan(tmp_path / "it.svg", two_rooms, title="two rooms", date="2026-01-02")
    text = (tmp_path / "it.svg").read_text()
    door = f"{two_rooms.doors[0].width:.2f}"
    assert all(word in text for word in ("two rooms", "room 1", "19.6 m2", door, "2026-01-02"))


def test_a_sheet_says_what_is_in_doubt(tmp_path):
    """Catches rooms without a door whose doubt is told on the screen only."""
    alone = rooms_of_squares(2.0, 2.0)
    exports.write_plan(tmp_path / "it.svg", alone, verdict="GOOD: all is well")
    text = (tmp_path / "it.svg").read_text()
    assert "GOOD: all is well" in text and f"in doubt: {alone.doubt}" in text
    assert "no door was seen of room 1, room 2" in alone.doubt


def test_a_sheet_has_its_source_and_the_widths_of_all_openings(tmp_path):
    """Catches an opening to where nobody looked that is a gap without its width."""
    log = load("room")
    walls = reduction.one_per_wall(build_map(log, log.truth, keep_points=True))
    free = quadtree.build_map(log, log.truth, resolution=0.05, free_resolution=0.05)
    found = plan.floor_plan(walls, free)
    exports.write_plan(tmp_path / "it.svg", found, source="61 scans")
    text = (tmp_path / "it.svg").read_text()
    (opening,) = found.openings_to_nowhere
    assert opening.rooms == (-1, 0) and opening.width == pytest.approx(0.9, abs=0.06)
    assert len(re.findall(r">\d\.\d\d m</text>", text)) == 3 and ">61 scans<" in text


def test_walls_that_cross_aslant_are_drawn(two_rooms, tmp_path):
    """Catches bodies of walls that cross themselves where they meet, and end in a foreign error."""
    segments = np.array(
        [
            [(12.6332, -1.6198), (12.632, 0.8736)],
            [(11.209, -1.146), (12.2553, -0.8916)],
            [(11.2308, -1.3398), (12.2792, -0.8774)],
        ]
    )
    walls = reduction.Reduction(segments, np.arange(3), 0.0, "floor_plan")
    sizes = {"thickness": np.array([0.25547, 0.15755, 0.05799]), "side": np.array([-1, 1, -1])}
    exports.write_plan(tmp_path / "it.svg", replace(two_rooms, walls=walls, **sizes))


def test_another_ending_is_refused(two_rooms, tmp_path):
    """Catches a file of no format."""
    with pytest.raises(ValueError, match=r"\.geojson"):
        exports.write_plan(tmp_path / "it.doc", two_rooms)


def test_a_sheet_holds_rooms_that_reach_beyond_their_walls(tmp_path):
    """Catches a room that is cut off by the edge of the paper: only its walls were counted."""
    walls = [[(4, 0), (0, 0)], [(0, 0), (0, 3)], [(0, 3), (4, 3)]]
    free = map_of_grid(np.ones((60, 400)), resolution=0.05)
    found = plan.floor_plan(walls, free)
    assert np.ptp(found.rooms[0].outline[:, 0]) == pytest.approx(20, abs=0.2)
    exports.write_plan(tmp_path / "it.svg", found)
    assert "1 : 100" in (tmp_path / "it.svg").read_text(encoding="utf-8")


def test_words_of_a_sheet_stand_on_no_wall_and_on_no_others(tmp_path):
    """Catches words across a wall or other words, a room without any, a sum of other rooms, and a
    drawing whose letters have another scale than its sheet, or stand elsewhere."""
    kinds = np.full((280, 760), UNKNOWN)
    kinds[10:170, 10:750] = FREE  # a hall of 37 m by 8 m, and behind it closets of 1.25 m by 2 m
    corners = [[(0.5, 0.5), (37.5, 0.5)], [(37.5, 0.5), (37.5, 8.5)], [(0.5, 8.5), (0.5, 0.5)]]
    walls = [*corners, [(0.5, 8.5), (37.5, 8.5)]]
    walls += [[(x, 8.7), (x, 10.6)] for x in (19.2, 25.1)]  # no words can stand here
    for x in (4.0, 5.4, 6.8, 20.0, 23.05):  # and between the last two only those of one
        left, right = round(x / 0.05), round((x + 1.25) / 0.05)
        kinds[172:212, left:right] = kinds[170:172, left + 5 : right - 5] = FREE
        walls += list(polyline([(x, 8.6), (x, 10.6), (x + 1.25, 10.6), (x + 1.25, 8.6)]))
    kinds[(kinds == UNKNOWN) & ndimage.binary_dilation(kinds == FREE)] = OCCUPIED
    drawn = plan.floor_plan(np.array(walls), map_of_grid(kinds, resolution=0.05))
    for name in ("it.svg", "it.dxf"):
        exports.write_plan(tmp_path / name, drawn, verdict="GOOD")
    space = ezdxf.readfile(tmp_path / "it.dxf").modelspace()
    texts = [*space.query("TEXT")]
    words = [one.dxf.text for one in texts]
    height = np.array([one.dxf.height for one in texts])
    middle = np.array([one.dxf.align_point.vec2 for one in texts])
    half = np.stack([[0.36 * len(one) for one in words] * height, height / 2], -1)
    boxes = shapely.box(*(middle - half).T, *(middle + half).T)
    lines = {"WALLS": [], "TEXT": []}  # walls without a body, and leaders
    for one in space.query("LINE"):
        lines[one.dxf.layer].append([one.dxf.start.vec2, one.dxf.end.vec2])
    faces = shapely.linestrings(np.array(lines["WALLS"]))
    assert len(drawn.rooms) == 6 == sum(one.startswith("room") for one in words)
    assert len(lines["TEXT"]) == 5  # a closet is 6.25 mm wide
    assert not shapely.intersects(boxes, shapely.union_all(faces)).any()
    meeting = shapely.STRtree(boxes).query(boxes, "intersects")
    assert (meeting[0] == meeting[1]).all()
    text = (tmp_path / "it.svg").read_text(encoding="utf-8")
    scale = float(re.search(r"1 : (\d+)", text).group(1)) / 1000
    assert scale == 0.2 and height.max() == pytest.approx(2.5 * scale)
    pattern = r'font-size: ([\d.]+)px[^>]*middle[^>]*x="([\d.]+)" y="([\d.]+)"[^>]*>([^<]+)<'
    size, x, y, sheet_words = np.array(re.findall(pattern, text)).T
    size, x, y = np.array([size, x, y], float) * 25.4 / 72 * scale
    assert sheet_words.tolist() == words and np.allclose(size * 0.73, height, rtol=0.01)
    off = np.stack([x, -y + 0.37 * size], -1) - middle
    assert np.allclose(off, off.mean(0), atol=0.2 * scale)  # descenders
    assert f">{sum(room.area for room in drawn.rooms):.1f} m2</text>" in text
