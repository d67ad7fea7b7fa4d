"""Floor plans of simulated offices, whose rooms and doors are known."""

from dataclasses import replace

import numpy as np
import pytest
from plan_buildings import rooms_of_squares

from segmap import build_map, load, plan, quadtree, reduction
from segmap.poses import compose, transform
from segmap.quadtree import FREE, OCCUPIED, UNKNOWN, map_of_grid
from segmap.simulation import Sensor, box, drive, office, polyline, simulate

LASER = Sensor("whole turn", 720, -np.pi, np.pi / 360, max_range=20.0, sigma=0.01)
ROOMS = 3


def seen(walls, way, turn=0.0, seed=0):
    """Segments and free space of a drive, at true poses, the frame turned."""
    log = simulate(walls, drive(way, step=0.4), sensor=LASER, rng=np.random.default_rng(seed))
    poses = compose((0, 0, turn), log.truth)
    walls = reduction.one_per_wall(build_map(log, poses, keep_points=True))
    return walls, quadtree.build_map(log, poses, resolution=0.05, free_resolution=0.05)


def office_seen(seed, turn=0.0):
    way = [(1.0, 5.0)]
    for x in 4.0 * np.arange(ROOMS) + 2.0:
        way += [(x, 5.0), (x, 7.3), (x, 5.0), (x, 2.7), (x, 5.0)]
    return seen(office(rng=np.random.default_rng(seed), rooms=ROOMS), way, turn, seed)


def seen_free(stray=(0.0, 0.0)):
    """A ray of a metre, and one from a stray place."""
    tree = quadtree.QuadtreeMap(resolution=0.05, free_resolution=0.05)
    for x, y in ((0.0, 0.0), stray):
        tree.insert_scan((x, y), [(x + 1.0, y)])
    return tree


@pytest.fixture(scope="module")
def offices():
    return {turn: plan.floor_plan(*office_seen(1, turn=turn)) for turn in (0.0, 0.4, np.pi / 2)}


@pytest.mark.parametrize("turn", [0.0, 0.4, np.pi / 2])
def test_an_office_has_its_rooms_and_doors(offices, turn):
    """Catches a niche that becomes a room, a door that is lost, a plan that follows the frame."""
    found = offices[turn]
    assert len(found.rooms) == 2 * ROOMS + 1 and len(found.doors) == 2 * ROOMS
    corridor = found.rooms[0]
    assert corridor.area == pytest.approx(2.0 * 4.0 * ROOMS, rel=0.04)
    assert all(0 in door.rooms for door in found.doors)
    assert all(door.width == pytest.approx(0.85, abs=0.11) for door in found.doors)
    middles = transform((0, 0, turn), [(4 * k + 2.0, y) for k in range(ROOMS) for y in (2.5, 7.5)])
    assert sorted(found.room_at(middles)) == [*range(1, 2 * ROOMS + 1)]
    assert found.room_at(transform((0, 0, turn), [(1.0, 5.0), (50, 50)])).tolist() == [0, -1]


def test_walls_are_straight_and_meet(offices):
    """Catches corners that stay open, crumbs among walls, and segments that are lost silently."""
    found = offices[0.0]
    ends = found.walls.segments.reshape(-1, 2)
    for corner in [(0, 4), (0, 6), (12, 4), (12, 6)]:  # of the corridor
        near = ends[np.hypot(*(ends - corner).T) < 0.05].round(9)
        assert len(np.unique(near, axis=0)) < len(near)
    assert np.hypot(*np.diff(found.walls.segments, axis=1)[:, 0].T).min() >= 0.3
    one_of_both = (found.walls.parents >= 0) ^ (found.clutter.parents >= 0)
    assert one_of_both.all()
    assert all(len(found.walls.members(k)) for k in range(len(found.walls)))


def test_thin_walls_have_a_thickness(offices):
    """Catches a thickness across a room, and the free side taken for the back."""
    found = offices[0.0]
    known = np.isfinite(found.thickness)
    assert known.mean() > 0.3
    assert (abs(found.thickness[known] - 0.1) < 0.01).mean() > 0.9  # the others are cupboards


def test_a_shaft_is_narrower_than_walls_are_thick():
    """Catches a thickness across a shaft, and an axis below 0 where its walls lean by a little."""
    kinds = np.full((20, 180), UNKNOWN)
    kinds[5:15, 9:171], kinds[6:14, 10:170] = OCCUPIED, FREE
    walls = transform((0, 0, -0.001), box(8, 0.4, (4.5, 0.5, 0)))
    found = plan.floor_plan(walls, map_of_grid(kinds, resolution=0.05))
    assert len(found.walls) == 4 and np.isnan(found.thickness).all()
    assert found.axes == pytest.approx(np.pi / 2 - 0.001)


def test_the_graph_is_of_the_rooms_that_doors_join(offices):
    """Catches a graph of one way only."""
    found = offices[0.0]
    assert found.graph.sum() == 4 * ROOMS and (found.graph == found.graph.T).all()


def test_what_no_door_joins_is_told():
    """Catches a door through a wall."""
    found = rooms_of_squares(2.0, 2.0)
    assert [round(room.area, 1) for room in found.rooms] == [19.6, 19.6] and not found.doors
    assert "no door was seen of room 1, room 2" in found.doubt
    found.rooms[0] = replace(found.rooms[0], name="hall")
    assert "no door was seen of hall, room 2" in found.doubt
    assert "cells between lines" in found.rooms[0].reason


def test_a_niche_is_no_room_where_the_rule_of_circles_holds():
    """Catches the rule left out: then a door niche is a room of its own."""
    walls = polyline(
        [(0, 0), (6, 0), (6, 4), (3.5, 4), (3.5, 5.3), (2, 5.3), (2, 4), (0, 4)], closed=True
    )
    found = seen(walls, [(1, 1), (5, 1), (5, 3), (2.7, 3)])
    assert len(plan.floor_plan(*found).rooms) == 1
    assert len(plan.floor_plan(*found, kappa=0.1).rooms) == 2


def test_a_corridor_with_recesses_is_not_cut():
    """Catches a doorway across a corridor, at its corners or where doors stand back."""
    log = load("corridor")
    walls = reduction.one_per_wall(build_map(log, log.truth, keep_points=True).filtered(0.1))
    free = quadtree.build_map(log, log.truth, resolution=0.05, free_resolution=0.05)
    found = plan.floor_plan(walls, free)
    assert len(found.rooms) == 1 and not found.doors and not found.doubt


def test_somebody_who_stood_in_a_door_does_not_shut_it():
    """Catches a square that is a wall because a few of many rays ended there."""
    corners = [(0, 0), (4.9, 0), (4.9, 1.6), (5.1, 1.6), (5.1, 0), (10, 0)]
    corners += [(10, 4), (5.1, 4), (5.1, 2.5), (4.9, 2.5), (4.9, 4), (0, 4)]
    building = polyline(corners, closed=True)
    walls, free = seen(building, [(2, 2), (8, 2), (2, 2)])
    somebody = polyline([(4.8, 1.7), (5.2, 1.7), (5.2, 2.4), (4.8, 2.4)], closed=True)
    stops = np.array([(1.0, 2, 0), (1.4, 2, 0), (1.8, 2, 0), (9.0, 2, 0)])
    rng = np.random.default_rng(1)
    for scan, pose in zip(simulate([*building, *somebody], stops, sensor=LASER, rng=rng), stops,
                          strict=True):  # fmt: skip
        free.insert_scan(pose[:2], transform(pose, scan.points()))
    found = plan.floor_plan(walls, free)
    assert len(found.rooms) == 2 and found.doors[0].width == pytest.approx(0.9, abs=0.11)


@pytest.mark.parametrize("low, high, doors", [(2.0, 2.9, 1), (2.0, 2.4, 0), (0.5, 1.4, 1)])
def test_a_door_has_a_width_and_may_stand_at_a_corner(low, high, doors):
    """Catches a slit that is a door, and a door that the wall beside it has no piece for."""
    assert len(rooms_of_squares(low, high).doors) == doors


@pytest.mark.parametrize(("width", "depth"), [(24, 24), (28, 19)])
def test_a_closet_with_a_door_is_a_room(width, depth):
    """Catches a small room that counts as floor of the next one, or is lost; squares of 5 cm."""
    kinds = np.full((100, 150), UNKNOWN)
    kinds[9:91, 9:91], kinds[29 : 31 + width, 90 : 93 + depth] = OCCUPIED, OCCUPIED
    kinds[10:90, 10:90] = kinds[30 : 30 + width, 92 : 92 + depth] = kinds[33:51, 90:92] = FREE
    right, top = 4.6 + depth / 20, 1.5 + width / 20
    room = polyline([(4.5, 1.65), (4.5, 0.5), (0.5, 0.5), (0.5, 4.5), (4.5, 4.5), (4.5, 2.55)])
    closet = [(4.6, 1.65), (4.6, 1.5), (right, 1.5), (right, top), (4.6, top), (4.6, 2.55)]
    found = plan.floor_plan([*room, *polyline(closet)], map_of_grid(kinds, resolution=0.05))
    area = width * depth / 400
    assert [room.area for room in found.rooms] == [16, pytest.approx(area, abs=0.15)]


def test_an_opening_too_wide_for_a_door_joins_both_sides():
    """Catches a hall in two, since more than half of what stands between is a wall."""
    kinds = np.full((140, 220), UNKNOWN)
    kinds[9:131, 9:211], kinds[10:130, 10:210] = OCCUPIED, FREE
    kinds[10:78, 109:111] = OCCUPIED
    around = polyline([(0.5, 0.5), (10.5, 0.5), (10.5, 6.5), (0.5, 6.5)], closed=True)
    found = plan.floor_plan(
        [*around, [(5.5, 0.5), (5.5, 3.9)]], map_of_grid(kinds, resolution=0.05)
    )
    assert len(found.rooms) == 1 and not found.doors


def two_rooms_with(wall, furniture=(), turn=0.0, sensor=LASER, low=1.6):
    """The plan of two rooms of 4 x 4 m behind a wall with a door of 0.9 m."""
    high = low + 0.9
    left = polyline([(4, low), (4, 0), (0, 0), (0, 4), (4, 4), (4, high)])
    right = (-1, 1) * (left - (4, 0)) + (4 + wall, 0)
    jambs = [[(4, y), (4 + wall, y)] for y in (low, high)]
    door = (4 + wall / 2, low + 0.45)
    way = [(0.6, 0.6), (2, 3.4), (2, 2), door, (6, 2), (6, 3.4), (7, 0.8)]
    walls, rng = np.concatenate([left, right, jambs, *furniture]), np.random.default_rng(0)
    log = simulate(walls, drive(way, step=0.2), sensor=sensor, rng=rng)
    poses = compose((0, 0, turn), log.truth)
    walls = reduction.one_per_wall(build_map(log, poses, keep_points=True))
    finest = {"resolution": 0.05, "free_resolution": 0.05}
    return plan.floor_plan(walls, quadtree.build_map(log, poses, **finest))


@pytest.mark.parametrize("wall", [0.05, 0.12, 0.2, 0.3])
@pytest.mark.parametrize("sensor", [LASER, replace(LASER, sigma=0.005), replace(LASER, sigma=0.02)])
def test_faces_bound_a_room_whatever_the_wall(wall, sensor):
    """Catches a room that reaches to the middle of its walls, or into the sill of its door, and a
    free side behind the other face of a thin wall."""
    found = two_rooms_with(wall, sensor=sensor)
    assert [room.area for room in found.rooms] == [pytest.approx(16, rel=0.02)] * 2
    assert len(found.doors) == 1 and all(room.hidden < 0.1 for room in found.rooms)
    known = found.thickness[np.isfinite(found.thickness)]  # of two faces at both sides of a door
    assert len(known) == 4 and known == pytest.approx(wall, abs=0.02)


@pytest.mark.parametrize("turn", [0.0, 0.5, 2.0])
def test_furniture_counts_as_floor_that_nobody_saw(turn):
    """Catches a room that ends before a wardrobe, in the middle of a wall or at a corner."""
    wardrobe, corner = box(0.6, 2.0, (0.3, 2.2, 0)), box(0.5, 0.8, (7.95, 3.6, 0))
    found = two_rooms_with(0.2, [wardrobe, corner], turn)
    assert [room.area for room in found.rooms] == [pytest.approx(16, rel=0.02)] * 2
    assert sorted(room.hidden for room in found.rooms) == [
        pytest.approx(x, abs=0.15) for x in (0.4, 1.2)
    ]


@pytest.mark.parametrize("turn", [0.0, 0.6, 2.2])
def test_a_room_is_as_large_in_every_frame(turn):
    """Catches a sill that is part of a room where its border, of squares, crosses itself."""
    found = two_rooms_with(0.2, [box(0.6, 0.9, (7.95, 0.3, 0.9))], turn, low=0.16)
    assert [room.area for room in found.rooms] == [pytest.approx(16, abs=0.05)] * 2


def test_a_wall_that_reaches_into_a_room_is_no_furniture():
    """Catches a partition of two metres whose area counts as floor."""
    partition = polyline([(1.8, 0), (1.8, 2.2), (2.1, 2.2), (2.1, 0)])
    found = two_rooms_with(0.2, [partition])
    assert min(room.area for room in found.rooms) == pytest.approx(16 - 2.2 * 0.3, rel=0.02)


def test_a_wall_across_a_corner_is_no_furniture():
    """Catches a chamfer whose corner counts as floor."""
    walls = polyline([(0, 0), (4, 0), (4, 3), (3, 4), (0, 4)], closed=True)
    (room,) = plan.floor_plan(*seen(walls, [(1, 1), (3, 1), (2, 3)])).rooms
    assert room.area == pytest.approx(15.5, rel=0.01) and room.hidden == 0


@pytest.mark.parametrize(("at", "step", "area"), [(7, 0.2, 42 - 1.4), (4, 0.3, 42 - 1.2)])
def test_a_wall_that_steps_back_is_no_furniture(at, step, area):
    """Catches floor that is made of a thicker part of a wall, up to the corner of its room."""
    walls = polyline(
        [(0, 0), (14, 0), (14, 3), (at, 3), (at, 3 - step), (0, 3 - step)], closed=True
    )
    (room,) = plan.floor_plan(*seen(walls, [(1, 1), (13, 1), (7, 1.6)])).rooms
    assert room.area == pytest.approx(area, rel=0.01) and room.hidden == 0


def one_room():
    """Squares of a room of 5 x 4 m, and what makes the plan of them and of walls."""
    kinds = np.full((120, 150), UNKNOWN)
    kinds[9:91, 9:111], kinds[10:90, 10:110] = OCCUPIED, FREE
    return kinds, lambda walls: plan.floor_plan(walls, map_of_grid(kinds, resolution=0.05))


def test_a_pillar_is_not_free_inside():
    """Catches a small place that nobody saw, between walls, that counts as free."""
    kinds, planned = one_room()
    kinds[40:52, 40:52] = OCCUPIED
    kinds[41:51, 41:51] = UNKNOWN
    found = planned([*box(5, 4, (3.0, 2.5, 0)), *box(0.6, 0.6, (2.3, 2.3, 0))])
    assert len(found.walls) == 8 and found.side.all()


@pytest.mark.parametrize("wide", [18, 20, 24])
def test_the_inside_of_a_wall_is_no_floor(wide):
    """Catches a wall that is floor, since the sill of its door is half of it."""
    kinds, low, high = np.full((60, 240), UNKNOWN), 30 - wide // 2, 30 + wide // 2
    kinds[9:51, 9:211] = OCCUPIED
    kinds[10:50, 10:108] = kinds[10:50, 112:210] = kinds[low:high, 108:112] = FREE
    kinds[10:low, 109:111] = kinds[high:50, 109:111] = UNKNOWN
    outer = polyline([(0.5, 0.5), (10.5, 0.5), (10.5, 2.5), (0.5, 2.5)], closed=True)
    ends = (0.5, low / 20), (high / 20, 2.5)
    faces = [[(x, start), (x, end)] for x in (5.4, 5.6) for start, end in ends]
    found = plan.floor_plan([*outer, *faces], map_of_grid(kinds, resolution=0.05))
    assert [room.area for room in found.rooms] == [pytest.approx(4.9 * 2, abs=0.05)] * 2


def test_a_ray_through_a_door_makes_no_opening():
    """Catches a large place outside that one ray frees."""
    kinds, planned = one_room()
    kinds[40:58, 110:112] = kinds[40:45, 112:140] = FREE
    walls = polyline([(5.5, 2.0), (5.5, 0.5), (0.5, 0.5), (0.5, 4.5), (5.5, 4.5), (5.5, 2.9)])
    found = planned(walls)
    assert not found.openings_to_nowhere and not found.doubt


def test_a_chimney_counts_as_floor():
    """Catches a wide and flat one that is taken for a wall that steps back."""
    chimney = [(5, 4), (5, 3.65), (1, 3.65), (1, 4)]
    walls = polyline([(0, 0), (6, 0), (6, 4), *chimney, (0, 4)], closed=True)
    (room,) = plan.floor_plan(*seen(walls, [(1, 1), (5, 1), (3, 2)])).rooms
    assert room.area == pytest.approx(24, rel=0.01)
    assert room.hidden == pytest.approx(4 * 0.35, abs=0.15)


def test_furniture_that_stands_free_makes_no_room_and_no_door():
    """Catches a passage between a table and a wall that becomes a doorway."""
    for x, y in ((1.3, 1.4), (2.2, 2.6), (2.6, 1.2)):
        found = two_rooms_with(0.12, [box(0.9, 0.5, (x, y, 0.0))])
        assert len(found.rooms) == 2 and len(found.doors) == 1


def test_a_line_lies_where_most_of_its_wall_does():
    """Catches a room that a short piece beside its wall makes smaller."""
    kinds = np.full((80, 100), UNKNOWN)
    kinds[9:71, 9:91], kinds[10:70, 10:90] = OCCUPIED, FREE
    corners = [(4.5, 0.5), (4.5, 3.5), (0.5, 3.5), (0.5, 0.5), (4.1, 0.5)]
    walls = [*polyline(corners), [(4.0, 0.62), (4.5, 0.62)]]
    (room,) = plan.floor_plan(walls, map_of_grid(kinds, resolution=0.05)).rooms
    assert room.outline[:, 1].min() == pytest.approx(0.5, abs=1e-6)


@pytest.mark.parametrize(
    ("lean", "rooms", "words"),
    [(1, 1, "walls along no axis stand in a room, and may divide it"), (0, 2, "")],
)
def test_a_wall_aslant_that_cuts_no_room_is_doubted(lean, rooms, words):
    """Catches two rooms that are one, and no word of the slanted wall and its door between them."""
    outer, walls = polyline([(0, 0), (10, 0), (10, 4), (0, 4)], closed=True), list[np.ndarray]()
    for low, high in ((0, 1.1), (2, 4)):
        face = np.array([(5 - lean * y / 4, y) for y in (low, high)])
        walls.append(polyline([*face, *(face[::-1] + (0.12, 0))], closed=True))
    way = [(1, 1), (1, 3), (3.5, 1.6), (5.5, 1.6), (9, 1), (9, 3), (6, 3)]
    found = plan.floor_plan(*seen(np.concatenate([outer, *walls]), way))
    assert len(found.rooms) == rooms and found.doubt == words


@pytest.mark.parametrize("shift", [0.0, 0.01, 0.02, 0.03, 0.04])
def test_lines_that_nearly_coincide_cut_no_room(shift):
    """Catches a room in two where no square lies between the lines of some pieces in it."""
    kinds = np.full((84, 244), OCCUPIED)
    kinds[3:-3, 3:-3] = FREE
    outer = polyline([(0, 0), (12, 0), (12, 4), (0, 4)], closed=True)
    rows = [(1.0, 1.8, 1.89), (3.0, 6.0, 2.035), (8.0, 8.7, 2.045)]
    pieces = [[(x, y + shift), (end, y + shift)] for x, end, y in rows]
    free = map_of_grid(kinds, resolution=0.05, corner=(-0.1, -0.1))
    (room,) = plan.floor_plan(np.concatenate([outer, pieces]), free).rooms
    assert room.area == pytest.approx(48, rel=0.01)


@pytest.mark.parametrize("beyond", [-0.02, 0.0, 0.04, 0.1])
def test_free_squares_on_a_long_wall_are_no_room(beyond):
    """Catches a row of squares beyond the line of a wall of 12 m: a room, or a foreign error."""
    kinds = np.full((84, 244), OCCUPIED)
    kinds[2:-2, 2:-2] = FREE
    outer = polyline([(0, 0), (12, 0), (12, 4), (0, 4)], closed=True)
    free = map_of_grid(kinds, resolution=0.05, corner=(-0.1 + beyond, -0.1 + beyond))
    (room,) = plan.floor_plan(outer, free).rooms
    assert room.area == pytest.approx(48, rel=0.01)


def test_an_opening_with_one_jamb_is_no_door():
    """Catches the end of a wall in a room that is taken for a doorway."""
    outer = polyline([(0, 0), (6, 0), (6, 2), (0, 6.2)], closed=True)
    walls = np.concatenate([outer, [[(3, 0), (3, 2.6)]]])
    way = [(1, 1), (1, 4), (2.6, 3.4), (4, 2.5), (5, 1)]
    assert not plan.floor_plan(*seen(walls, way)).doors


def test_clutter_in_all_directions_is_no_axis():
    """Catches axes of what stands about: their lines cut rooms into crumbs that are none."""
    walls, free = office_seen(1)
    rng = np.random.default_rng(0)
    places, turns = rng.uniform((0, 0), (12, 10), (400, 2)), rng.uniform(0, np.pi, 400)
    half = 0.2 * np.stack([np.cos(turns), np.sin(turns)], -1)
    crumbs = np.stack([places - half, places + half], 1)
    found = plan.floor_plan(np.concatenate([walls.segments, crumbs]), free)
    assert len(found.axes) == 1
    assert sum(room.area for room in found.rooms) > 0.85 * 12 * 10


def test_a_plan_without_rooms_says_so():
    """Catches walls that lie far from what was seen, and a plan of nothing that has no doubt."""
    found = plan.floor_plan([[(90, 0), (93, 0)], [(93, 0), (93, 3)]], seen_free())
    assert not found.rooms and "no room was found" in found.doubt
