"""Edits of a floor plan: what a person says of rooms and doors, by places."""

import numpy as np
import pytest

from segmap.plan import (
    Furniture,
    Join,
    Name,
    NewDoor,
    NoDoor,
    Split,
    Wall,
    edits,
    floor_plan,
)
from segmap.quadtree import FREE, OCCUPIED, map_of_grid
from segmap.segments import point_distance

SIDE = 0.05
#: Middles of three rooms of 4 x 4 m in a row, walls of 0.2 m and doors of 0.9 m between them.
MIDDLES = [(2.5, 2.5), (6.7, 2.5), (10.9, 2.5)]


def row_of_rooms(*, shut=(), **options):
    """Three rooms in a row; the walls in `shut`, of 0 and 1, have no door."""
    cells = np.full((100, 268), OCCUPIED)
    walls = []
    for k in range(3):
        left = 0.5 + 4.2 * k
        cells[10:90, round(left / SIDE) : round(left / SIDE) + 80] = FREE
        corners = [(left, 0.5), (left + 4, 0.5), (left + 4, 4.5), (left, 4.5)]
        walls += [[corners[j], corners[(j + 1) % 4]] for j in (0, 2)]
        for x, wall in ((left, k - 1), (left + 4, k)):
            is_door = wall in (0, 1) and wall not in shut
            spans = [(0.5, 2.0), (2.9, 4.5)] if is_door else [(0.5, 4.5)]
            walls += [[(x, low), (x, high)] for low, high in spans]
    for wall in {0, 1} - set(shut):
        start = round((4.5 + 4.2 * wall) / SIDE)
        cells[40:58, start : start + 4] = FREE
    return floor_plan(np.array(walls), map_of_grid(cells, resolution=SIDE), **options)


@pytest.fixture(scope="module")
def row():
    return row_of_rooms()


def areas(plan):
    return sorted(round(room.area, 1) for room in plan.rooms)


def outlines(plan):
    return [np.round(room.outline, 9).tolist() for room in plan.rooms]


def test_a_row_of_three_rooms(row):
    """Catches a building of this file that is not what its tests take it for."""
    assert areas(row) == [16.0, 16.0, 16.0] and len(row.doors) == 2
    assert row.edits == () and not row.unplaced


def test_joined_rooms_are_one_and_their_door_is_none(row):
    """Catches a door that leads from a room into itself, and numbers in the place of places."""
    joined = row.edited([Join(MIDDLES[0], MIDDLES[1])])
    assert areas(joined) == [16.0, pytest.approx(32.2, abs=0.25)] and len(joined.doors) == 1
    assert joined.room_at(MIDDLES).tolist() == [0, 0, 1]
    assert joined.doors[0].rooms == (0, 1) and joined.rooms[0].reason == "mended by hand"
    assert joined.rooms[1].reason == row.rooms[2].reason
    all_three = row.edited([Join(MIDDLES[0], MIDDLES[1]), Join(MIDDLES[1], MIDDLES[2])])
    assert len(all_three.rooms) == 1 and not all_three.doors


def test_rooms_behind_a_wall_join_and_rooms_farther_apart_do_not():
    """Catches one number for two islands, of which the smaller is lost from the plan."""
    apart = row_of_rooms(shut=(0, 1))
    joined = apart.edited([Join(MIDDLES[0], MIDDLES[1])])
    assert areas(joined) == [16.0, pytest.approx(32.8, abs=0.25)]
    refused = apart.edited([Join(MIDDLES[0], MIDDLES[2])])
    assert outlines(refused) == outlines(apart)
    assert refused.unplaced == ["Join 2.5 2.5 10.9 2.5 (more than 0.5 m lie between the two rooms)"]


@pytest.mark.parametrize("pair", [(0, 1), (0, 2), (2, 3)])
def test_a_join_keeps_the_floor_behind_furniture_and_takes_the_wall_between(pair):
    """Catches floor that was of a room only by the wall between both, and a wall in a room."""
    cells = np.full((108, 168), OCCUPIED)
    for left, low in [(2, 2), (86, 2), (2, 56), (86, 56)]:
        cells[low : low + 50, left : left + 80] = FREE
    cells[2:14, 68:82] = cells[40:52, 86:100] = cells[56:66, 2:16] = OCCUPIED
    cells[56:66, 70:82] = OCCUPIED
    walls = [[(0.1, y), (8.3, y)] for y in (0.1, 2.6, 2.8, 5.3)]
    walls += [[(x, 0.1), (x, 5.3)] for x in (0.1, 4.1, 4.3, 8.3)]
    for x, y, corner in [(3.4, 0.7, (4.1, 0.1)), (5, 2, (4.3, 2.6)), (0.8, 3.3, (0.1, 2.8))]:
        walls += [[(x, y), (x, corner[1])], [(x, y), (corner[0], y)]]
    walls += [[(3.5, 3.3), (3.5, 2.8)], [(3.5, 3.3), (4.1, 3.3)]]
    plan = floor_plan(np.array(walls), map_of_grid(cells, resolution=SIDE))
    places = np.array([(2, 1.5), (6.5, 1.5), (2, 4), (6.5, 4)])
    one, other = plan.room_at(places[[*pair]])
    both = plan.rooms[one].polygon.union(plan.rooms[other].polygon)
    joined = plan.edited([Join(*places[[*pair]])])
    whole = joined.rooms[joined.room_at(places[[pair[0]]])[0]]
    gap = 0.2 * (2.5 if pair != (0, 2) else 4.0)
    assert areas(plan) == [10.0] * 4 and not joined.unplaced
    assert both.difference(whole.polygon).area < 0.01
    assert whole.area == pytest.approx(20 + gap, abs=0.1)
    assert sum(room.area for room in joined.rooms) == pytest.approx(40 + gap, abs=0.1)
    middle = places[[*pair]].mean(0)
    assert point_distance(middle, joined.walls.segments).min() > 0.5


@pytest.mark.parametrize("turn", [0.0, 0.3, 2.0])
def test_a_split_cuts_a_room_where_it_is_drawn(row, turn):
    """Catches a cut that leaks over corners of squares, one at the wrong place, a lost sliver."""
    middle, way = np.array(MIDDLES[1]), np.array([-np.sin(turn), np.cos(turn)])
    cut = row.edited([Split(middle + 0.2 - 2 * way, middle + 0.2 + 2 * way)])
    assert len(cut.rooms) == 4 and not cut.unplaced
    assert sum(room.area for room in cut.rooms) == pytest.approx(48.0, abs=0.02)
    sides = middle + 0.2 + np.outer([-0.3, 0.3], (way[1], -way[0]))
    assert len(set(cut.room_at(sides))) == 2
    if turn == 0:
        assert areas(cut) == [7.2, 8.8, 16.0, 16.0]


def test_joining_the_pieces_undoes_a_split(row):
    """Catches squares that a cut loses."""
    cut = Split((6.7, 0.6), (6.7, 4.4))
    again = row.edited([cut, Join((5.0, 2.5), (8.0, 2.5))])
    assert outlines(again) == outlines(row)


def test_a_door_that_is_none_goes_and_its_rooms_stay(row):
    """Catches the other door taken, and rooms joined with their door."""
    left = row.edited([NoDoor((8.8, 2.4))])
    assert len(left.rooms) == 3 and [door.place[0] for door in left.doors] == [
        pytest.approx(4.6, abs=0.11)
    ]
    assert "no door was seen of" in left.doubt


def test_a_door_that_is_refused_may_go_with_a_join(row):
    """Catches a join that is refused since the door between both rooms was refused before."""
    edits = [NoDoor((4.6, 2.4)), Join(MIDDLES[0], MIDDLES[1])]
    for both in (edits, edits[::-1]):
        plan = row.edited(both)
        assert len(plan.rooms) == 2 and len(plan.doors) == 1 and not plan.unplaced


def test_names_stay_with_their_places(row):
    """Catches names that follow the number of a room, which a join changes."""
    named = [Name((10.0, 1.0), "store"), Name((2.0, 2.0), "hall")]
    plan = row.edited([*named, Join(MIDDLES[1], MIDDLES[2])])
    assert plan.rooms[plan.room_at([(10.0, 1.0)])[0]].name == "store"
    assert plan.rooms[plan.room_at([(2.0, 2.0)])[0]].name == "hall"
    assert row.edited([*named, Name((2.2, 2.0), "lobby")]).rooms[0].name == "lobby"


@pytest.mark.parametrize(
    "edit, words",
    [
        (Join(MIDDLES[0], (40, 2)), "Join 2.5 2.5 40 2 .no room"),
        (Join((1, 1), (2, 3)), "both places are in one room"),
        (Split((20, 0), (20, 9)), "Split 20 0 20 9 .no room at its middle"),
        (Split((2, 2.5), (3, 2.5)), "draw it from wall to wall"),
        (Split((2.5, 2.5), (2.5, 2.5)), "draw it from wall to wall"),
        (NoDoor((2.5, 2.5)), "NoDoor 2.5 2.5 .no door"),
        (Name((40, 2), "hall"), "Name 40 2 hall .no room"),
    ],
)
def test_what_finds_nothing_is_told_and_changes_nothing(row, edit, words):
    """Catches an edit that is dropped, or takes what is far off, and others that are not done."""
    plan = row.edited([edit, Name(MIDDLES[2], "store")])
    assert outlines(plan) == outlines(row) and len(plan.doors) == 2
    assert len(plan.unplaced) == 1 and plan.edits[0] == edit
    with pytest.raises(AssertionError, match=words):
        raise AssertionError(plan.doubt)
    assert "store" in {room.name for room in plan.rooms}


def test_edits_are_kept_as_text():
    """Catches an edit that a session does not bring back, and a stranger's that is taken."""
    some = [Join((1, 2), (3, 4)), Split((0, 0), (1, 1e-3)), NoDoor((-2, 2)), Name((1, 1), "a,  b")]
    some += [NewDoor((4, 2.8), (4, 3.7)), Wall((1.5, -2)), Furniture((4, 0.8))]
    assert [edits.read(str(edit)) for edit in some] == some
    for text in (
        "Paint 1 2",
        "Join 1 2 3",
        "Join 1 2 3 4 5",
        "Name 1 2",
        "NoDoor 1 x",
        "Name 1 hall",
        "NewDoor 1 2",
        "Furniture 1 2 3",
    ):
        with pytest.raises(ValueError, match="edit must"):
            edits.read(text)


def test_a_turned_map_has_turned_edits(row):
    """Catches a place that turns about the wrong point, and a name that is turned."""
    turned = Join((1, 0), (0, 2)).turned(np.pi / 2)
    assert np.allclose([turned.a, turned.b], [(0, 1), (-2, 0)])
    assert Name((1, 0), "hall").turned(np.pi).text == "hall"
    assert NewDoor((4, 2.8), (4, 3.7)).turned(np.pi / 2).end == pytest.approx((-3.7, 4))
