"""Outlines of rooms: sides on walls, over furniture, without the sills of doors."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import scipy

from ..arrays import Array
from ..segments import MIN_LENGTH, length
from ._cells import SHORTEST_ALONE_M, THICKEST_WALL_M, Grid, Mask
from ._lines import Indices
from ._polygons import Room, shapely_or_hint
from ._walls import CORNER_TURN_RAD, FACE_GAP_M, FACE_TURN_RAD, normals

#: Walls `(n, 2, 2)`, their free sides, and their lengths: infinite where one is no furniture.
Bounds = tuple[Array, Indices, Array]
#: Slits and spikes that are narrower, metres, are none.
SLIT_M = 0.15
#: Steps of one square in a side are none, in squares.
SMOOTHED_SQUARES = 1.2
#: A room reaches half a square beyond its free squares, and a little more, in squares.
GROWN_SQUARES = 0.7
#: Corners that are so near to a straight side are none, metres.
STRAIGHT_M = 0.01
#: Sides of a ring that are so near to a wall along them, metres, move onto it.
SNAP_M = 0.2
#: Sides that are on one line are so near to it, metres.
SAME_LINE_M = 0.05
#: What nobody saw is furniture where it is as wide, in squares; less was seen in part, along walls.
NARROWEST_FURNITURE_SQUARES = 5
#: What stands at a wall and reaches farther into a room, metres, is a wall itself where it has a
#: side as long as one that stands alone.
DEEPEST_FURNITURE_M = 0.8


def room_of(
    parts: Indices, number: int, box: tuple[slice, ...], grid: Grid, walls: Bounds,
    doorways: Array, least: float,
) -> Room:  # fmt: skip
    """The room of the squares in a box that have a number, without a name."""
    shapely, own = shapely_or_hint(), parts[box] == number

    def placed(at: Array | Indices) -> Array:  # columns and rows
        start = box[1].start, box[0].start
        return grid.origin + (at + start) * grid.side @ [grid.right, grid.up]

    def border(axis: int) -> Array:  # sides of squares, rows and columns
        start = np.argwhere(np.diff(own.astype(np.int8), axis=axis, prepend=0, append=0))
        return np.stack([start, start + np.eye(2)[1 - axis]], 1)

    lines = shapely.linestrings(np.concatenate([border(0), border(1)])[..., ::-1])
    squares = shapely.simplify(shapely.build_area(shapely.multilinestrings(lines)), 0)
    slit, buffer = SLIT_M / grid.side / 2, partial(shapely.buffer, join_style="mitre")
    grown = buffer(squares, slit)
    whole = shapely.intersection(buffer(buffer(grown, -2 * slit), slit + GROWN_SQUARES), grown)
    whole = squares if whole.is_empty else whole  # all of it is narrower than a slit
    whole, rings = largest(shapely.simplify(whole, SMOOTHED_SQUARES)), list[Array]()
    others = (parts >= 0) & (parts != number)
    furniture = np.ones((NARROWEST_FURNITURE_SQUARES, NARROWEST_FURNITURE_SQUARES), bool)
    unseen = scipy.ndimage.binary_opening(own & ~grid.seen[box], furniture)
    hidden = float(unseen.sum()) * grid.side**2
    for ring in (whole.exterior, *whole.interiors):
        corners = placed(np.array(ring.coords)[:-1] - 0.5)
        corners, area = outline_of(corners, walls, doorways, others, grid, least)
        rings.append(corners)
        hidden += area
    clean = shapely.buffer(shapely.Polygon(rings[0], rings[1:]), 0)
    whole = largest(shapely.simplify(clean, STRAIGHT_M))
    holes = [np.array(k.coords)[:-1] for k in whole.interiors if shapely.Polygon(k).area < least]
    holes = [hole for hole in holes if np.inf not in sides_on_walls(hole, walls)[1]]
    filled = shapely.union_all([whole, *map(shapely.Polygon, holes)])
    return room_within(filled, hidden + filled.area - whole.area)


def room_within(shape: Any, hidden: float) -> Room:
    """The room in the largest part of a shape, without a name."""
    shapely, shape = shapely_or_hint(), largest(shape)
    outline, *holes = (np.array(r.coords)[:-1] for r in (shape.exterior, *shape.interiors))
    widest = shapely.maximum_inscribed_circle(shape, tolerance=STRAIGHT_M)
    place = shapely.get_coordinates(widest)[0]
    return Room("", outline, holes, shape.area, shape.length, place, min(hidden, shape.area), "")


def apart(rooms: list[Room], grid: Grid, parts: Indices) -> list[Room]:
    """The same rooms: what two of them cover is of that with more squares there."""
    shapely, rooms = shapely_or_hint(), rooms.copy()
    shapes = np.array([room.polygon for room in rooms], object)
    for one, other in shapely.STRtree(shapes).query(shapes, "intersects").T.tolist():
        shared = shapely.intersection(shapes[one], shapes[other])
        if one < other and shared.area > MIN_LENGTH:
            box = grid.box(shapely.get_coordinates(shared))
            there = parts[box][shapely.contains_xy(shared, *np.moveaxis(grid.places(box), -1, 0))]
            k, rest = sorted((one, other), key=lambda k: ((there == k).sum(), rooms[k].area))
            rooms[k] = room_within(shapely.difference(shapes[k], shapes[rest]), rooms[k].hidden)
            shapes[k] = rooms[k].polygon
    return rooms


def largest(polygons: Any) -> Any:
    """The largest part, its outline counter-clockwise and its holes clockwise."""
    shapely = shapely_or_hint()
    return max(shapely.get_parts(shapely.orient_polygons(polygons)), key=lambda part: part.area)


def outline_of(
    ring: Array, walls: Bounds, doorways: Array, others: Mask, grid: Grid, least: float
) -> tuple[Array, float]:
    """A ring of corners whose sides are on walls, and the area in it that furniture hides.

    The inside of the ring is on its left. Between two sides on walls, on one line or at a right
    angle, stands furniture where the area is below `least` and no square of `others` is in it. A
    niche in a wall with one of the `doorways`, `(d, 2)`, is the sill of a door.
    """
    sides, wall = sides_on_walls(ring, walls)
    corners = [lines_meeting(*pair) for pair in zip(sides, np.roll(sides, -1, axis=0), strict=True)]
    hidden, steps, refused = 0.0, 2, set[bytes]()
    while (count := len(sides)) >= steps + 2:
        if steps == 2:  # another ring
            around = np.concatenate([sides[-1:], sides, sides])
            normal, size = normals(around)[1:], np.concatenate([wall, wall])
        turn = (normal[:count] * normal[steps:][:count]).sum(1)  # its cosine
        fits = (abs(turn) < np.sin(FACE_TURN_RAD)) | (turn > np.cos(FACE_TURN_RAD))
        fits &= np.minimum(size[:count], size[steps:][:count]) > 0
        for first in np.flatnonzero(fits):
            window = around[first : first + steps + 3].tobytes()
            if window in refused:
                continue
            refused.add(window)
            ahead = corners[first:] + corners[:first]
            border = between(sides[first], sides[(first + steps) % len(sides)], ahead, steps)
            if not len(border):
                continue
            (x, y), (next_x, next_y) = border.T, np.roll(border, -1, axis=0).T
            area = float(next_x @ y - next_y @ x) / 2  # positive before the walls
            if not 0 < abs(area) <= least or crossing_area(border, abs(area)) > SLIT_M**2:
                continue
            turned, long = np.roll(sides, -first, axis=0), np.roll(wall, -first)
            if area < 0:
                goes = is_sill(turned[[0, steps]], border, doorways)
            else:
                goes = is_furniture(turned[: steps + 1], long[1:steps], border, others, grid)
                hidden += area if goes else 0.0
            if goes:
                sides, wall = (np.delete(each, np.s_[1:steps], axis=0) for each in (turned, long))
                corners, steps = [lines_meeting(*sides[:2]), *ahead[steps:]], 1
                break
        steps += 1
    return np.concatenate(corners), hidden


def crossing_area(border: Array, area: float) -> float:
    """By how much the area that a border goes round is larger than its signed area."""
    shapely, shape = shapely_or_hint(), shapely_or_hint().Polygon(border)
    return 0.0 if shape.is_valid else float(shapely.make_valid(shape).area) - area


def depth(both: Array, border: Array) -> float:
    """How far a border `(m, 2)` reaches from the nearer of the lines of two sides, metres."""
    away = ((border - both[:, None, 0]) * normals(both)[:, None]).sum(-1)
    return float(abs(away).max(1).min())


def is_sill(both: Array, border: Array, doorways: Array) -> bool:
    """Whether what lies behind two sides is as deep as a wall and has a doorway."""
    shapely = shapely_or_hint()
    near = shapely.dwithin(shapely.Polygon(border), shapely.points(doorways), SLIT_M)
    return depth(both, border) <= THICKEST_WALL_M and bool(near.any())


def is_furniture(sides: Array, wall: Array, border: Array, others: Mask, grid: Grid) -> bool:
    """Whether what sides go round, from the first to the last, belongs to the floor.

    `wall` are the sizes of the walls on which those between are. One side alone cuts a corner
    off, and a long one that reaches far into the room is a wall too. At a corner of the room so is
    one behind which no face would go on: there the wall steps back.
    """
    shapely, both = shapely_or_hint(), sides[[0, -1]]
    ways = normals(both) @ [[0, -1], [1, 0]]
    across = abs(normals(sides[1:-1]) @ ways.T).max(1)
    longest = SHORTEST_ALONE_M if depth(both, border) > DEEPEST_FURNITURE_M else FACE_GAP_M
    if len(wall) < 2 or np.inf in wall or max(wall * across) >= longest:
        return False
    inner = shapely.buffer(shapely.make_valid(shapely.Polygon(border)), -SLIT_M / 2)
    box = grid.box(border)
    return not shapely.contains_xy(inner, *grid.places(box)[others[box]].T).any()


def sides_on_walls(ring: Array, bounds: Bounds) -> tuple[Array, Array]:
    """Sides `(n, 2, 2)` of a ring, and the size of the wall that each is on, 0 for none.

    A side goes onto the wall that covers most of it and whose free side is the inside.
    """
    walls, side, sizes = bounds
    sides = np.stack([ring, np.roll(ring, -1, axis=0)], 1)
    if not len(walls):
        return sides, np.zeros(len(ring))
    normal, inside, size = normals(walls), normals(sides), length(sides)
    way = inside @ [[0, -1], [1, 0]]
    start, end = (way @ walls[:, k].T - (ring * way).sum(1)[:, None] for k in (0, 1))
    low, high = (each.clip(0, size[:, None]) for each in (np.fmin(start, end), np.fmax(start, end)))
    off = ring @ normal.T - (walls[:, 0] * normal).sum(1) + (low + high) / 2 * (way @ normal.T)
    facing = inside @ normal.T
    facing = np.where(side == 0, abs(facing), side * facing)
    cover = (high - low) * (SNAP_M - abs(off)).clip(0)
    cover[facing < np.cos(FACE_TURN_RAD)] = 0
    best, is_on = cover.argmax(1), cover.max(1) > 0
    away = ((sides - walls[best, :1]) * normal[best, None]).sum(-1) * is_on[:, None]
    return sides - away[..., None] * normal[best, None], np.where(is_on, sizes[best], 0.0)


def between(one: Array, other: Array, corners: list[Array], steps: int) -> Array:
    """Border `(m, 2)` of what lies between a side of a ring, that after so many steps, and both.

    `corners` are where the line of each side meets that of the next one, beginning with the first
    of both. Nothing, `(0, 2)`, where they are not on one line, and do not meet at a right angle
    ahead.
    """
    way, to = one[1] - one[0], other[1] - other[0]
    tip = lines_meeting(one, other)
    if len(tip) > 1:
        away = abs((other - one[0]) @ (-way[1], way[0])).max()
        if steps < 3 or away > SAME_LINE_M * np.hypot(*way):
            return tip[:0]
        tip = tip[:0]
    else:
        start, end = corners[-1][-1], corners[steps][0]
        if (tip[0] - start) @ way <= MIN_LENGTH or (end - tip[0]) @ to <= MIN_LENGTH:
            return tip[:0]
    return np.concatenate([*corners[:steps], tip])


def lines_meeting(one: Array, other: Array) -> Array:
    """Where the lines of two sides meet, `(1, 2)`; of parallel ones the ends that follow."""
    (u, v), to = (one[1] - one[0], other[1] - other[0]), other[0] - one[0]
    across = u[0] * v[1] - u[1] * v[0]
    if abs(across) > np.sin(CORNER_TURN_RAD) * np.hypot(*u) * np.hypot(*v):
        return (one[0] + (to[0] * v[1] - to[1] * v[0]) / across * u)[None]
    return np.stack([one[1], other[0]])
