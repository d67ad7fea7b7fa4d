"""Simulated buildings whose rooms and doors are known, and how a plan agrees with them."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import shapely
from shapely import affinity

from segmap import build_map, quadtree, reduction
from segmap.plan import FloorPlan, floor_plan
from segmap.simulation import SICK_LMS200, URG_04LX, Sensor, drive, polyline, simulate

WHOLE_TURN = Sensor("whole turn", 720, -np.pi, np.pi / 360, max_range=20.0, sigma=0.01)
SENSORS = {"URG": URG_04LX, "SICK": SICK_LMS200, "360": WHOLE_TURN}
#: Walls between rooms, metres.
WALL_M = 0.12
DOOR_M = 0.9
#: A room is found where it has so much of the union in common; its area and a door's width are
#: right within so much; a door lies so near its place.
FOUND_UNION, AREA_SHARE, WIDTH_M, PLACE_M = 0.8, 0.03, 0.12, 0.4


class Building(NamedTuple):
    """Rooms as polygons, doors as their place and width, walls that a laser sees, a way through."""

    rooms: list
    doors: list
    walls: np.ndarray
    way: list


def built(rooms, doors, way, *, obstacles=(), glass=(), leaves=(), shut=(), turn=0.0):
    """A building of rooms that doors, rectangles through the walls, join.

    `obstacles` stand in rooms, `glass` covers what a laser does not see, `leaves` are lines.
    """
    free = shapely.union_all([*rooms, *doors])
    free = shapely.difference(shapely.union_all([free, *shut]), shapely.union_all([*obstacles]))
    lines = shapely.difference(free.boundary, shapely.union_all([*glass]))
    parts = [*shapely.get_parts(shapely.line_merge(lines)), *map(shapely.LineString, leaves)]
    turned = [affinity.rotate(part, turn, origin=(0, 0)) for part in parts]
    corners = [shapely.get_coordinates(part) for part in turned]
    walls = np.concatenate([np.stack([c[:-1], c[1:]], 1) for c in corners])
    big = [one for one in obstacles if one.area >= 1.5]  # what is smaller belongs to the floor
    true = [shapely.difference(room, shapely.union_all([*big])) for room in rooms]
    widths = [max(np.ptp(shapely.get_coordinates(d), axis=0) - [0, 0]) for d in doors]
    places = [affinity.rotate(d.centroid, turn, origin=(0, 0)) for d in doors]
    return Building(
        [affinity.rotate(room, turn, origin=(0, 0)) for room in true],
        [(shapely.get_coordinates(p)[0], w) for p, w in zip(places, widths, strict=True)],
        walls,
        shapely.get_coordinates(affinity.rotate(shapely.LineString(way), turn, origin=(0, 0))),
    )


def box(x, y, width, depth):
    return shapely.box(x, y, x + width, y + depth)


def two_rooms(rng, *, wall=WALL_M, wide=DOOR_M, leaf=None):
    """Two rooms side by side, and the opening in the wall between them."""
    width, depth = rng.uniform(3.6, 5.0, 2)
    at = rng.uniform(0.6, depth - wide - 0.6)
    rooms = [box(0, 0, width, depth), box(width + wall, 0, rng.uniform(3.6, 5.0), depth)]
    doors = [box(width - 0.01, at, wall + 0.02, wide)]
    mid, end, leaves, past = at + wide / 2, width + wall, [], 0.25
    if leaf is not None:  # hinged at the lower jamb, it opens into the second room
        turn = np.radians(leaf)
        leaves = [[(end, at), (end + wide * np.sin(turn), at + wide * np.cos(turn))]]
        past = wide / 2 + 0.15
    way = [(1, 1), (1, depth - 1), (width - 0.8, mid), (end + 0.5, mid + past)]
    return built(rooms, doors, [*way, (end + 1.6, depth - 0.9), (end + 2.4, 0.9)], leaves=leaves)


def any_leaf(rng):
    """Walls, doors and leaves of all sizes; the plan may be mirrored, so hinges lie anywhere."""
    sizes = rng.uniform(0.08, 0.35), rng.uniform(0.7, 1.0), rng.uniform(20, 90)
    found = two_rooms(rng, wall=sizes[0], wide=sizes[1], leaf=sizes[2])
    flip = rng.choice([-1.0, 1.0], 2)
    return Building(
        [affinity.scale(room, *flip, origin=(0, 0)) for room in found.rooms],
        [(place * flip, width) for place, width in found.doors],
        found.walls * flip,
        found.way * flip,
    )


def leaf_open(low, high):
    return lambda rng: two_rooms(rng, leaf=rng.uniform(low, high))


def round_room(rng):
    radius = rng.uniform(2.5, 4.5)
    way = [(radius * 0.5 * np.cos(t), radius * 0.5 * np.sin(t)) for t in (0, 2, 4, 6)]
    return built([shapely.Point(0, 0).buffer(radius, quad_segs=24)], [], way)


def l_corridor(rng):
    one, other = rng.uniform(8, 14, 2)
    room = box(0, 0, one, 2).union(box(0, 0, 2, other))
    return built([room], [], [(one - 1, 1), (1, 1), (1, other - 1)])


def t_corridor(rng):
    one, other = rng.uniform(9, 14), rng.uniform(5, 8)
    room = box(0, 0, one, 2).union(box(one / 2 - 1, 0, 2, other))
    return built(
        [room], [], [(1, 1), (one / 2, 1.1), (one / 2, other - 1), (one / 2, 1), (one - 1, 1)]
    )


def pillars(rng):
    width, depth = rng.uniform(11, 14), rng.uniform(8, 10)
    stand = [
        box(x - 0.2, y - 0.2, 0.4, 0.4)
        for x in np.linspace(0, width, 5)[1:-1]
        for y in (depth / 3, 2 * depth / 3)
    ]
    way = [(1, 1), (width - 1, 1), (width - 1, depth - 1), (1, depth - 1), (1, depth / 2)]
    return built(
        [box(0, 0, width, depth)], [], [*way, (width - 1, depth / 2 + 0.1)], obstacles=stand
    )


def glass_outside(rng):
    width, depth = rng.uniform(4, 6, 2)
    pane = box(width - 0.1, 1, 0.2, rng.uniform(1.2, 2.2))
    way = [(1, 1), (1, depth - 1), (width - 1, depth - 1.1), (width - 1, 1)]
    return built([box(0, 0, width, depth)], [], way, glass=[pane])


def glass_between(rng):
    """Two rooms with a door to a corridor each, and a pane of glass between them."""
    width, depth = rng.uniform(4, 5, 2)
    pane = rng.uniform(1.2, 2.0)
    rooms = [box(0, 0, 2 * width + WALL_M, 2)]
    rooms += [box(k * (width + WALL_M), 2 + WALL_M, width, depth) for k in (0, 1)]
    doors = [box(k * (width + WALL_M) + 1, 1.99, DOOR_M, WALL_M + 0.02) for k in (0, 1)]
    gap = box(width - 0.01, 3, WALL_M + 0.02, pane)
    way = [(1, 1)]
    for k in (0, 1):
        x = k * (width + WALL_M) + 1 + DOOR_M / 2
        way += [(x, 1), (x, 3), (x + 1, depth), (x, 3.1), (x, 1)]
    return built(rooms, doors, way, shut=[gap])


def whole_wall_furnished(rng):
    width, depth = rng.uniform(4, 6, 2)
    sizes = rng.uniform(0.35, 0.6, 4)
    stand = [box(k * width / 4, depth - s, width / 4, s) for k, s in enumerate(sizes)]
    room = shapely.difference(box(0, 0, width, depth), shapely.union_all(stand))
    way = [(1, 1), (1, depth - 1.5), (width - 1, depth - 1.4), (width - 1, 1)]
    return built([room], [], way)


def long_corridor(rng):
    starts = np.arange(4) * 14 + rng.uniform(2, 6, 4)
    rooms = [box(0, 0, 60, 2), *(box(x, 2 + WALL_M, 4.5, 4) for x in starts)]
    doors = [box(x + 1.5, 1.99, DOOR_M, WALL_M + 0.02) for x in starts]
    way = [(1, 1)]
    for x in starts:
        way += [(x + 1.95, 1), (x + 1.95, 4), (x + 1.95, 1)]
    return built(rooms, doors, [*way, (59, 1)])


def wide_mouths(rng):
    """A corridor that is narrower than the openings of its rooms."""
    widths = rng.uniform(2.5, 2.8, 3)
    starts = np.arange(3) * 3.2 + 0.5
    rooms = [box(0, 0, 10, 1.7)]
    rooms += [box(x, 1.7 + WALL_M, w, 3.5) for x, w in zip(starts, widths, strict=True)]
    doors = [
        box(x + 0.35, 1.69, w - 0.7, WALL_M + 0.02) for x, w in zip(starts, widths, strict=True)
    ]
    way = [(0.8, 0.8)]
    for x in starts + 1.3:
        way += [(x, 0.8), (x, 4), (x, 0.8)]
    return built(rooms, doors, [*way, (9.3, 0.8)])


def corridor_into_a_room(rng):
    """A corridor that ends in a room with its full width."""
    long = rng.uniform(6, 9)
    rooms = [box(0, 0, 5, 5), box(5, 1, long, 1.6)]
    way = [(1, 1), (1, 4), (4, 1.8), (4 + long, 1.8)]
    return built(rooms, [box(4.99, 1, 0.02, 1.6)], way)


def suite(rng, *, turn=0.0, furnished=False):
    """A corridor with two rooms; furnished, the leaves of their doors stand open at 60 degrees."""
    width = rng.uniform(4, 5, 2)
    rooms = [box(0, 0, width.sum() + WALL_M, 2), box(0, 2 + WALL_M, width[0], 4)]
    rooms += [box(width[0] + WALL_M, 2 + WALL_M, width[1], 4)]
    at = 1.5, width[0] + WALL_M + 1.5
    doors = [box(x, 1.99, DOOR_M, WALL_M + 0.02) for x in at]
    way = [(1, 1)]
    for x in at:
        way += [(x + 0.45, 1), (x + 0.45, 4), (x + 1, 5), (x + 0.45, 4.1), (x + 0.45, 1)]
    leaves, stand = [], []
    if furnished:
        leaf = DOOR_M * np.array([np.cos(np.pi / 3), np.sin(np.pi / 3)])
        leaves = [[(x, 2 + WALL_M), (x + leaf[0], 2 + WALL_M + leaf[1])] for x in at]
        stand = [box(x + 1.6, rng.uniform(3, 5), 0.45, 0.45) for x in at]
        stand += [box(x - 1, 6.12 - 0.6, rng.uniform(1, 1.6), 0.6) for x in at]
        way = [(1, 1)]
        for x in at:
            way += [(x + 0.8, 1), (x + 0.8, 2.3), (x + 1.2, 2.8), (x + 0.9, 4.5), (x + 1.2, 2.8)]
            way += [(x + 0.8, 2.3), (x + 0.8, 1)]
    return built(rooms, doors, way, turn=turn, leaves=leaves, obstacles=stand)


def wings(rng):
    """A corridor that bends by 45 degrees; a room in each wing."""
    long, other = rng.uniform(8, 10, 2)
    bend = np.array([long, 0.0])
    along = np.array([np.sqrt(0.5), np.sqrt(0.5)])
    left = np.array([-along[1], along[0]])
    inner = (long - 2 * np.tan(np.pi / 8), 2)
    far = bend + other * along
    corridor = shapely.Polygon([(0, 0), bend, far, far + 2 * left, inner, (0, 2)])
    one = box(1, 2 + WALL_M, 4, 3.5)
    two = affinity.rotate(box(other - 5, -WALL_M - 3.5, 4, 3.5), 45, origin=(0, 0))
    door = affinity.rotate(box(other - 4, -WALL_M - 0.01, DOOR_M, WALL_M + 0.02), 45, origin=(0, 0))
    two, door = (affinity.translate(each, long, 0) for each in (two, door))
    inside = bend + (other - 4 + 0.45) * along - 2 * left
    front = bend + (other - 4 + 0.45) * along + 1.0 * left
    way = [(1, 1), (2.95, 1), (2.95, 4), (2.95, 1), (long - 0.4, 1), front, inside, front + 0.01]
    found = built([corridor, one, two], [box(2.5, 1.99, DOOR_M, WALL_M + 0.02), door], way)
    return found._replace(doors=[found.doors[0], (found.doors[1][0], DOOR_M)])


def half_seen(rng):
    width, depth = rng.uniform(12, 14), rng.uniform(9, 10)
    return built([box(0, 0, width, depth)], [], [(1.5, 1.5), (1.5, 3), (1.5, depth - 3.5)])


def half_seen_behind(rng):
    """A room seen from its corridor, through the door, and never entered."""
    width, depth = rng.uniform(4, 5), rng.uniform(4, 5)
    rooms = [box(0, 0, 8, 2), box(2, 2 + WALL_M, width, depth)]
    doors = [box(4, 1.99, DOOR_M, WALL_M + 0.02)]
    return built(rooms, doors, [(1, 1), (7, 1)])


KINDS: dict[str, Callable] = {
    "two rooms": two_rooms,
    "leaf at 20 to 40": leaf_open(20, 40),
    "leaf at 40 to 70": leaf_open(40, 70),
    "leaf at 70 to 90": leaf_open(70, 90),
    "any leaf": any_leaf,
    "wall as thick as the band": lambda rng: two_rooms(rng, wall=0.15, leaf=rng.uniform(40, 70)),
    "furnished, leaves at 60": lambda rng: suite(rng, furnished=True),
    "round": round_room,
    "L corridor": l_corridor,
    "T corridor": t_corridor,
    "pillars": pillars,
    "opening of 2 m": lambda rng: two_rooms(rng, wide=2.0),
    "glass outside": glass_outside,
    "glass between": glass_between,
    "thin walls": lambda rng: two_rooms(rng, wall=0.08),
    "furniture along a wall": whole_wall_furnished,
    "corridor of 60 m": long_corridor,
    "mouths wider than the corridor": wide_mouths,
    "corridor into a room": corridor_into_a_room,
    "turned by 17 degrees": lambda rng: suite(rng, turn=17),
    "wings at 45 degrees": wings,
    "half seen": half_seen,
    "seen through a door": half_seen_behind,
}


def log_of(building, sensor, seed):
    path = drive(building.way, step=0.25, turn=np.radians(20))
    return simulate(building.walls, path, sensor=sensor, rng=np.random.default_rng(seed))


def seen(log, poses):
    """Reduced walls and free space of a log, as the command makes them."""
    walls = reduction.one_per_wall(build_map(log, poses, keep_points=True).filtered(0.1))
    return walls, quadtree.build_map(log, poses, resolution=0.05, free_resolution=0.05)


def wrong_in(plan: FloorPlan, building: Building) -> list[str]:
    """What a plan has otherwise than its building, in words."""
    found, wrong = [shapely.Polygon(room.outline, room.holes) for room in plan.rooms], []
    for k, room in enumerate(building.rooms):
        shares = [one.intersection(room).area / one.union(room).area for one in found]
        best = int(np.argmax(shares)) if shares else -1
        if best < 0 or shares[best] < FOUND_UNION:
            wrong.append(f"room {k} of {room.area:.1f} m2 not found ({max(shares, default=0):.2f})")
        elif abs(found[best].area / room.area - 1) > AREA_SHARE:
            wrong.append(f"room {k} has {found[best].area:.1f} of {room.area:.1f} m2")
    if len(found) > len(building.rooms):
        wrong.append(f"{len(found) - len(building.rooms)} rooms too many")
    left = [*plan.doors]
    for place, width in building.doors:
        near = [one for one in left if np.hypot(*(one.place - place)) < PLACE_M]
        if not near:
            wrong.append(f"door at {place.round(1)} lost")
            continue
        left.remove(near[0])
        if abs(near[0].width - width) > WIDTH_M:
            wrong.append(f"door has {near[0].width:.2f} of {width:.2f} m")
    return wrong + [f"false door of {one.width:.2f} m at {one.place.round(1)}" for one in left]


def rooms_of_squares(low: float, high: float) -> FloorPlan:
    """Two rooms of 4.9 m by 4 m, walls of 0.2 m, with an opening between these heights, metres."""
    kinds = np.full((100, 240), quadtree.UNKNOWN)
    kinds[9:91, 9:211] = quadtree.OCCUPIED
    kinds[10:90, 10:108] = kinds[10:90, 112:210] = quadtree.FREE
    kinds[round(low * 20) : round(high * 20), 108:112] = quadtree.FREE
    walls = polyline([(0.5, 0.5), (10.5, 0.5), (10.5, 4.5), (0.5, 4.5)], closed=True)
    between = [[(x, a), (x, b)] for x in (5.4, 5.6) for a, b in ((0.5, low), (high, 4.5)) if a < b]
    return floor_plan([*walls, *between], quadtree.map_of_grid(kinds, resolution=0.05))
