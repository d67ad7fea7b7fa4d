"""Edits of a floor plan that change its walls: doors, walls and furniture, by places."""

import numpy as np
import pytest
import shapely
from scipy import ndimage

from segmap import build_map, load, quadtree
from segmap.plan import Furniture, Join, Name, NewDoor, NoDoor, Split, Wall, floor_plan
from segmap.poses import compose
from segmap.quadtree import FREE, OCCUPIED, UNKNOWN, map_of_grid
from segmap.reduction import one_per_wall

SIDE = 0.05
DOOR = shapely.box(3.99, 1.5, 4.21, 2.4)
#: Two rooms of 4 x 4 m, with a wall of 0.2 m between them.
ROOMS = [shapely.box(0, 0, 4, 4), shapely.box(4.2, 0, 8.2, 4)]


def seen(*free, stand=(), clutter=(), **options):
    """A plan of what is free, but for boxes that stand in it; their faces are walls."""
    whole = shapely.difference(shapely.union_all(free), shapely.union_all([*stand]))
    left, low, right, high = whole.bounds
    x, y = (np.arange(a - 0.5, b + 0.5, SIDE) + SIDE / 2 for a, b in ((left, right), (low, high)))
    is_free = shapely.contains_xy(whole, x, y[:, None])
    kinds = np.where(ndimage.binary_dilation(is_free, np.ones((3, 3))), OCCUPIED, UNKNOWN)
    kinds[is_free] = FREE
    rings = [r for p in shapely.get_parts(whole.simplify(0)) for r in (p.exterior, *p.interiors)]
    corners = [np.array(ring.coords) for ring in rings]
    walls = [np.stack([c[:-1], c[1:]], 1) for c in corners] + [np.reshape(clutter, (-1, 2, 2))]
    tree = map_of_grid(kinds, resolution=SIDE, corner=(left - 0.5, low - 0.5))
    return floor_plan(np.concatenate(walls), tree, **options)


def areas(plan):
    return sorted(round(room.area, 2) for room in plan.rooms)


def outlines(plan):
    return [np.round(room.outline, 9).tolist() for room in plan.rooms]


@pytest.fixture(scope="module")
def two():
    return seen(*ROOMS, DOOR)


@pytest.fixture(scope="module")
def wardrobes():
    """A room of 7 x 4.8 m in two, by a wardrobe of 0.6 m that stands across it, or along a wall."""
    across, along = shapely.box(3.2, 0.9, 3.8, 3.9), shapely.box(1.4, 1.4, 2.0, 4.6)
    rooms = shapely.box(0, 0, 7, 4.8), shapely.box(0, 0, 7, 6)
    return [
        (seen(room, stand=[one]), room, one)
        for room, one in zip(rooms, (across, along), strict=True)
    ]


def test_these_buildings_are_as_their_tests_take_them(two, wardrobes):
    """Catches a rule that leaves no false room to be mended."""
    assert areas(two) == [16.0, 16.0] and len(two.doors) == 1
    assert [len(plan.rooms) for plan, _, _ in wardrobes] == [2, 2]


@pytest.mark.parametrize("which, side", [(0, 0), (0, 2), (1, 0), (1, 2)])
def test_a_wardrobe_that_made_another_room_goes_with_one_edit(wardrobes, which, side):
    """Catches a floor under it that is no room, its back and sides that stay walls, its doors."""
    plan, room, stands = wardrobes[which]
    left, low, right, high = stands.bounds
    mended = plan.edited([Furniture(((left, (left + right) / 2, right)[side], (low + high) / 2))])
    assert areas(mended) == [pytest.approx(room.area, abs=0.05)] and not mended.doors
    assert mended.rooms[0].hidden == pytest.approx(stands.area, abs=0.15)
    assert len(mended.walls) == 4 and len(mended.clutter) == 4 and not mended.doubt
    assert areas(plan.edited([])) == areas(plan) and len(plan.walls) == 8


def test_a_front_over_the_whole_wall_moves_back_to_the_wall():
    """Catches rooms back to back that become one, a wall of another room that counts as floor, and
    a room whose border nobody saw."""
    room, niche = shapely.box(0, 0, 3.4, 4), shapely.box(3.3, 2.5, 4, 4)
    plan = seen(room, niche, ROOMS[1])
    assert areas(plan) == [pytest.approx(14.5, abs=0.1), 16.0]
    mended = plan.edited([Furniture((3.4, 1.2))])
    assert areas(mended) == [pytest.approx(16.0, abs=0.05)] * 2 and not mended.unplaced
    assert mended.doubt == "no door was seen of room 1, room 2"
    built_in = seen(ROOMS[0], stand=[shapely.box(2.8, 0, 4, 1.6)])
    assert areas(built_in) == [pytest.approx(16 - 1.2 * 1.6, abs=0.02)]
    mended = built_in.edited([Furniture((2.8, 0.8))])
    assert areas(mended) == [pytest.approx(16.0, abs=0.01)] and len(mended.walls) == 4


def test_free_space_narrower_than_a_slit_is_no_room():
    """Catches a gap of 14 cm behind a wall that is a room, or ends in a foreign error."""
    plan = seen(shapely.box(0, 0, 8, 4), shapely.box(0, 4.3, 8, 4.44))
    assert areas(plan) == [32.0]


def test_a_run_between_two_rooms_is_none_where_it_is_furniture(two):
    """Catches rooms that stay two, and the wall that stays."""
    shelf = two.edited([Furniture((4.0, 0.8))])
    assert areas(shelf) == [pytest.approx(32 + 0.2 * 2.4, abs=0.05)] and not shelf.doors
    assert len(shelf.walls) == len(two.walls) - 2


def test_a_shaft_is_no_furniture_where_a_person_says_so():
    """Catches a wall that still counts as the floor behind it, and one that stays so after undo."""
    plan = seen(ROOMS[0], stand=[shapely.box(1.5, 1.5, 2.5, 2.5)])
    assert areas(plan) == [16.0]
    shaft = plan.edited([Wall((1.5, 2.0))])
    assert areas(shaft) == [pytest.approx(15.0, abs=0.01)] and len(shaft.rooms[0].holes) == 1
    assert shaft.rooms[0].hidden == 0 and areas(shaft.edited([])) == [16.0]
    again = plan.edited([Wall((1.5, 2.0)), Furniture((1.5, 2.0))])
    assert areas(again) == [16.0]
    desk = seen(ROOMS[0], stand=[shapely.box(0, 0, 1.4, 0.7)])
    assert areas(desk) == [16.0]
    assert areas(desk.edited([Wall((0.7, 0.7))])) == [pytest.approx(16 - 1.4 * 0.7, abs=0.01)]


def test_a_wall_from_wall_to_wall_cuts_a_room():
    """Catches a partition along no axis that bounds nothing, and clutter that stays clutter."""
    plan = seen(shapely.box(0, 0, 8, 4), clutter=[[(2.5, 0.05), (4.5, 3.95)]])
    assert areas(plan) == [32.0]
    cut = plan.edited([Wall((3.5, 2.0))])
    assert areas(cut) == [pytest.approx(14.0, abs=0.1), pytest.approx(18.0, abs=0.1)]
    assert len(set(cut.room_at([(3.0, 2.0), (4.0, 2.0)]))) == 2
    short = seen(shapely.box(0, 0, 8, 4), clutter=[[(3.0, 2.0), (3.2, 2.1)]])
    assert (len(short.walls), len(short.clutter)) == (4, 1)
    wall = short.edited([Wall((3.1, 2.0))])
    assert (len(wall.walls), len(wall.clutter)) == (5, 0) and not wall.unplaced
    assert areas(wall) == [32.0]


def test_a_door_between_two_rooms_has_its_clear_width(two):
    """Catches a door beside its wall, another width, rooms that it does not join."""
    shut = seen(*ROOMS)
    assert "no door was seen of room 1, room 2" in shut.doubt
    (door,) = shut.edited([NewDoor((4.1, 2.8), (4.15, 3.7))]).doors
    assert door.width == pytest.approx(0.9, abs=1e-9) and door.rooms == (0, 1)
    assert np.allclose(door.ends[:, 1], [2.8, 3.7])
    assert min(abs(door.ends[0, 0] - [4.0, 4.2])) < 1e-6
    plan = two.edited([NewDoor((4.0, 2.8), (4.0, 3.7))])
    assert len(plan.doors) == 2 and areas(plan) == [16.0, 16.0] and not plan.doubt
    narrower = two.edited([NewDoor((4.2, 1.6), (4.2, 2.3))])
    assert [door.width for door in narrower.doors] == [pytest.approx(0.7)]
    assert not two.edited([NewDoor((4.0, 2.8), (4.0, 3.7)), NoDoor((4.1, 3.2))]).doors[1:]


@pytest.mark.parametrize("ends", [(2.8, 3.7), (3.7, 2.8), (3.2, 4.0), (0.0, 4.0)])
def test_a_drawn_door_is_a_gap_in_both_faces_of_its_wall(ends):
    """Catches a sheet whose door is drawn over a wall, a gap in one face, or in all walls."""
    shut, (low, high) = seen(*ROOMS), sorted(ends)
    plan = shut.edited([NewDoor((4.0, ends[0]), (4.0, ends[1]))])
    walls, gap = shapely.linestrings(plan.walls.segments), shapely.box(3.9, low, 4.3, high)
    before = shapely.length(shapely.linestrings(shut.walls.segments)).sum()
    assert shapely.length(walls).sum() == pytest.approx(before - 2 * (high - low))
    assert shapely.length(shapely.intersection(walls, gap.buffer(-0.01))).sum() < 0.01
    assert len(plan.thickness) == len(plan.side) == len(plan.residual) == len(plan.walls)
    assert areas(plan) == [16.0, 16.0] and not len(plan.clutter)


def test_a_drawn_door_takes_no_floor():
    """Catches the strip beside a cupboard that is a sill where a door is drawn in its wall."""
    plan = seen(shapely.box(0, 0, 4, 4), stand=[shapely.box(0, 0, 0.4, 2.2)])
    assert areas(plan.edited([NewDoor((0, 2.6), (0, 3.5))])) == areas(plan) == [16.0]


@pytest.mark.parametrize("x", [4.0, 4.1, 4.2])
def test_a_doorway_is_drawn_anew_on_either_face_and_in_the_middle(two, x):
    """Catches the sill of a doorway, which is of one room, taken for both of its rooms."""
    for first in ([], [NoDoor((4.1, 2))]):
        plan = two.edited([*first, NewDoor((x, 1.6), (x, 2.3))])
        assert [(door.rooms, round(door.width, 9)) for door in plan.doors] == [((0, 1), 0.7)]


@pytest.mark.parametrize("ends", [((0, -3), (0, 5)), ((0.5, 0), (7, 0)), ((4, 3.2), (4, 4.6))])
def test_a_door_beyond_its_wall_is_told(two, ends):
    """Catches a door through a corner, or over two rooms."""
    plan = two.edited([NewDoor(*ends)])
    assert len(plan.doors) == 1 and "beyond its wall" in plan.unplaced[0]


def test_doors_round_a_corner_and_side_by_side_both_stand(two):
    """Catches a door that goes since another touches it, or is near on another wall."""
    corner = two.edited([NewDoor((0.1, 0), (1.1, 0)), NewDoor((0, 0.1), (0, 1.1))])
    beside = two.edited([NewDoor((4, 2.6), (4, 3.1)), NewDoor((4, 3.1), (4, 3.6))])
    assert len(corner.doors) == len(beside.doors) == 3


def test_furniture_where_a_wall_was_said_to_be_counts():
    """Catches the wall before it, told as one that changed nothing; and one after it, not told."""
    plan = seen(shapely.box(0, 0, 4, 4), stand=[shapely.box(1, 1, 1.5, 3)])
    assert not plan.edited([Wall((1.5, 2)), Furniture((1.5, 2))]).unplaced
    joined = seen(*ROOMS).edited([Furniture((4, 2)), Wall((4, 2))])
    assert len(joined.rooms) == 2 and not joined.unplaced
    desk = seen(ROOMS[0], stand=[shapely.box(0, 0, 1.4, 0.7)])
    assert desk.edited([Furniture((0, 2)), Wall((0, 2))]).unplaced


def test_furniture_on_a_long_wall_joins_the_room_behind_its_place():
    """Catches the room that lies behind most of the wall, or first along it."""
    plan = seen(shapely.box(0, 0, 3, 8), shapely.box(3.2, 0, 6, 3), shapely.box(3.2, 3.2, 6, 8))
    assert areas(plan) == [8.4, 13.44, 24.0]
    for y, others in ((1.5, [13.44]), (6.0, [8.4])):
        joined = plan.edited([Furniture((3.0, y))])
        assert areas(joined)[:-1] == others and joined.room_at([(1, 1), (5, y)]).tolist() == [0, 0]


@pytest.mark.parametrize(
    "free, stand",
    [
        ([shapely.box(0, 0, 7, 4.8)], [shapely.box(3.2, 0.9, 3.8, 3.9)]),
        ([shapely.box(0, 0, 3.4, 4), shapely.box(3.3, 2.5, 4, 4), ROOMS[1]], []),
        (
            [shapely.box(0, 0, 4, 4), shapely.box(4.1, 0, 8, 4), shapely.box(3.9, 1.5, 4.2, 2.4)],
            [shapely.box(3.5, 2.6, 4, 4), shapely.box(4.1, 0, 4.6, 1.4)],
        ),
    ],
)
def test_rooms_never_overlap(free, stand):
    """Catches the floor behind furniture in two rooms, and borders that go beyond their squares."""
    plan, rng = seen(*free, stand=stand), np.random.default_rng(0)
    runs = plan.walls.segments
    for at in runs[:, 0] + rng.uniform(0.05, 0.95, (len(runs), 1)) * (runs[:, 1] - runs[:, 0]):
        turn, middle = rng.uniform(0, np.pi), plan.rooms[rng.integers(len(plan.rooms))].place
        cut = 3 * np.array([np.cos(turn), np.sin(turn)])
        for some in ([Furniture(at)], [Wall(at), Split(middle - cut, middle + cut), Furniture(at)]):
            shapes = [shapely.Polygon(k.outline, k.holes) for k in plan.edited(some).rooms]
            whole = shapely.union_all(shapes).area
            assert sum(shape.area for shape in shapes) == pytest.approx(whole, abs=1e-5)


def test_a_door_may_lead_outside():
    """Catches the last room of a list behind an outer wall, to which a way leads round, and a room
    that is told to have no door."""
    plan = seen(*ROOMS).edited([NewDoor((0.1, 1.0), (0.1, 2.0)), NewDoor((8.2, 1.0), (8.2, 2.5))])
    assert {door.rooms for door in plan.doors} == {(-1, 0), (-1, 1)}
    assert not plan.graph.any() and not plan.doubt


def test_a_door_in_a_border_that_a_person_drew():
    """Catches a split that no door can pass."""
    plan = seen(shapely.box(0, 0, 8, 4)).edited(
        [Split((3, 0), (3, 4)), NewDoor((3.1, 1.0), (3.1, 1.9))]
    )
    assert [door.rooms for door in plan.doors] == [(0, 1)] and not plan.unplaced
    assert np.allclose(plan.doors[0].ends, [(3, 1), (3, 1.9)])


def test_a_join_takes_the_door_between_its_rooms(two):
    """Catches a join that is refused for a door that was drawn before."""
    plan = two.edited([NewDoor((4.0, 2.8), (4.0, 3.7)), Join((2, 2), (6, 2))])
    assert len(plan.rooms) == 1 and not plan.doors and not plan.unplaced


@pytest.mark.parametrize(
    "edit, words",
    [
        (NewDoor((3.5, 3.0), (4.7, 3.0)), "across a wall: draw it along"),
        (NewDoor((1.5, 2.0), (2.5, 2.0)), "no room, or one, on both sides"),
        (NewDoor((30, 2), (31, 2)), "no room, or one, on both sides"),
        (NewDoor((4.0, 3.0), (4.0, 3.1)), "narrower than 0.3 m"),
        (Wall((2.0, 2.0)), "no wall and no clutter there"),
        (Wall((4.0, 1.0)), "it changes no room"),
        (Furniture((2.0, 2.0)), "no wall there"),
        (Furniture((-40, 2.0)), "no wall there"),
        (Furniture((0.0, 2.0)), "neither a wall nor a room behind it"),
    ],
)
def test_what_finds_nothing_is_told_and_changes_nothing(two, edit, words):
    """Catches an edit of another plan that is dropped, or takes what is far off."""
    plan = two.edited([edit, Name((2, 2), "store")])
    assert outlines(plan) == outlines(two) and len(plan.doors) == 1
    assert len(plan.walls) == len(two.walls) and len(plan.unplaced) == 1
    assert f"{edit} ({words}" in plan.doubt
    assert "store" in {room.name for room in plan.rooms}


def test_edits_at_once_or_one_after_the_other_are_the_same(wardrobes):
    """Catches a state that one edited plan leaves in the next, and a room that is remembered with
    walls that were there before."""
    plan, room, stands = wardrobes[0]
    some = [Furniture((3.2, 2.4)), Split((5, 0), (5, 4.8)), NewDoor((5, 2), (5, 3)), Wall((3.2, 2))]
    some += [Join((4, 2), (6, 2)), Split((2, 0), (2, 4.8)), NoDoor((3.5, 0.4))]
    plan.edited(some[::-1])
    step = plan
    for k in range(len(some)):
        step = step.edited(some[: k + 1])
    at_once = seen(room, stand=[stands], edits=some)
    assert outlines(step) == outlines(plan.edited(some)) == outlines(at_once)
    assert step.edits == at_once.edits == tuple(some)
    assert outlines(step.edited([])) == outlines(plan) == outlines(plan.edited([]))


def test_what_is_only_looked_into_is_no_room():
    """Catches rays through a door that count as floor of the room before it, in some frames."""
    log = load("room")
    for turn in (0.0, 0.1, 0.9):
        poses = compose((0.3 * turn, 0.2 * turn, turn), log.truth)
        walls = one_per_wall(build_map(log, poses, keep_points=True))
        free = quadtree.build_map(log, poses, resolution=SIDE, free_resolution=SIDE)
        assert [room.area for room in floor_plan(walls, free).rooms] == [
            pytest.approx(area, abs=0.15) for area in (16.0, 15.2, 15.2)
        ]
