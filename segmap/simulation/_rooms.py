"""Rooms to simulate: each is an array of walls, segments `(n, 2, 2)` in metres.

Rooms lie with their lower left corner at the origin; only niches, of `corridor_loop`, lie beyond.
Where walls of several parts meet, coordinates are rounded to the micrometre: no beam slips between.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from .. import arrays
from ..arrays import Array, Count, Quantity, at_least, at_most, checked
from ..poses import transform

#: Width of a door, metres: an ordinary inside door.
DOOR = 0.9
#: No side of a building is longer, metres.
LONGEST_SIDE_M = 1e5
Length = Annotated[float, Quantity("metres", above=0, most=LONGEST_SIDE_M)]
Sides = Annotated[Count, at_least(3), at_most(100_000)]
#: Thickness of the walls between rooms, metres: a light partition.
THICKNESS = 0.1


@checked
def polyline(corners: ArrayLike, *, closed: bool = False) -> Array:
    """Walls from corner to corner `(k, 2)`, metres; where it is closed, back to the first.

    Examples
    --------
    >>> polyline([(0, 0), (1, 0), (1, 2)]).shape
    (2, 2, 2)
    >>> polyline([(0, 0), (1, 0), (0, 1)], closed=True)[-1]
    array([[0., 1.],
           [0., 0.]])
    """
    points = arrays.points(corners, "corners")
    following = np.roll(points, -1, axis=0)
    return np.stack([points, following], 1)[: len(points) if closed else max(len(points) - 1, 0)]


@checked
def box(width: Length, depth: Length, pose: ArrayLike = (0.0, 0.0, 0.0)) -> Array:
    """Four walls of a rectangle about a pose: a cupboard, a pillar, a table.

    Width and depth, metres, lie along the x and the y axis of the pose, `(3,)`, in metres and
    radians.

    Examples
    --------
    >>> box(2, 1, (1, 0.5, 0))[0]
    array([[0., 0.],
           [2., 0.]])
    """
    corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * (width / 2, depth / 2)
    return transform(arrays.pose(pose), polyline(corners, closed=True))


@checked
def rectangular_room(width: Length = 4.0, depth: Length = 3.0) -> Array:
    """A rectangle of walls from the origin to (width, depth), metres.

    Examples
    --------
    >>> rectangular_room(4, 3).max(axis=(0, 1))
    array([4., 3.])
    """
    return box(width, depth) + (width / 2, depth / 2)


@checked
def square_room(side: Length = 4.0) -> Array:
    """A square of walls from the origin to (side, side), metres.

    Examples
    --------
    >>> square_room(2).max(axis=(0, 1))
    array([2., 2.])
    """
    return rectangular_room(side, side)


@checked
def circular_room(radius: Length = 2.0, *, sides: Sides = 64) -> Array:
    """A round room as a polygon with its corners on the circle about (radius, radius), metres.

    With 64 sides the walls lie at most `radius * (1 - cos(pi / 64))` inside the circle: 2.4 mm for
    a radius of 2 m, well below the noise of any sensor here.

    Examples
    --------
    >>> walls = circular_room(2.0)
    >>> np.allclose(np.hypot(*(walls[:, 0] - 2.0).T), 2.0)
    True
    """
    turn = 2 * np.pi * np.arange(sides) / sides
    corners = radius + radius * np.stack([np.cos(turn), np.sin(turn)], -1)
    return polyline(corners, closed=True)


@checked
def two_position_square(side: Length = 4.0) -> tuple[Array, Array]:
    """A square room and the two places from which it is seen (B 6.2, Fig. 6.2).

    The robot stands in the middle of the upper left quarter, then of the lower right one, so each
    wall is once near and once far. Returned are walls `(4, 2, 2)` and poses `(2, 3)`.

    Examples
    --------
    >>> two_position_square(4)[1]
    array([[1., 3., 0.],
           [3., 1., 0.]])
    """
    return square_room(side), np.array([(1, 3, 0), (3, 1, 0)]) * (side / 4, side / 4, 1)


@checked
def corridor_loop(length: Length = 30.0, depth: Length = 12.0, *, width: Length = 2.0) -> Array:
    """A corridor around a block, with door niches and pillars.

    The niches (0.9 m wide, 0.2 m deep) are spaced unevenly, each wall in its own way: no two
    stretches look alike, and half a turn does not carry the loop onto itself.

    Parameters
    ----------
    length, depth
        Outer sides of the loop, along x and y.
    width : float
        Between the outer wall and the block.

    Examples
    --------
    >>> corridor_loop().min(axis=(0, 1)), corridor_loop().max(axis=(0, 1))
    (array([-0.2, -0.2]), array([30.2, 12.2]))
    """
    if min(length, depth) - 2 * width < 4 * DOOR:
        got = f"{length:g} x {depth:g} m with a corridor of {width:g} m"
        least = f"the block inside must measure at least {4 * DOOR:g} m in length and depth"
        raise ValueError(f"{least}, got a loop of {got}")
    outer = rectangular_room(length, depth)
    block = box(length - 2 * width, depth - 2 * width, (length / 2, depth / 2, 0))
    facing = [*outer, *block[:, ::-1]]
    walls = [_niches(wall, first=0.13 * i) for i, wall in enumerate(facing)]
    places = [(0.23, 0.0), (0.55, 1.0), (0.77, 0.0)]  # share of the length, side of the corridor
    pillars = [
        box(0.3, 0.3, (share * length, 0.15 + side * (width - 0.3), 0)) for share, side in places
    ]
    return np.round(np.concatenate([*walls, *pillars]), 6)


def _niches(wall: Array, *, first: float, depth: float = 0.2) -> Array:
    """A wall with a niche to its right about every 5 m, at steps of the golden section."""
    start, end = wall
    reach = float(np.hypot(*(end - start)))
    count = int(reach // 5)
    middles = reach * np.sort((first + np.arange(1, count + 1) * 0.618034) % 1)
    middles = np.clip(middles, DOOR, reach - DOOR)
    along = (middles[:, None] + np.array([-1, -1, 1, 1]) * DOOR / 2).ravel()
    return recess(wall, along, np.tile([0.0, depth, depth, 0.0], count))


def recess(wall: Array, along: Array, right: Array) -> Array:
    """Walls in the place of one: from its start by places along it, and to its right, metres."""
    reach = float(np.hypot(*(wall[1] - wall[0])))
    line = np.stack([np.r_[0, along, reach], -np.r_[0, right, 0]], -1)
    return transform(pose_at_start(wall), polyline(line))


def pose_at_start(wall: Array) -> Array:
    """The pose of a wall's start, looking along it."""
    return np.array([*wall[0], np.arctan2(*(wall[1] - wall[0])[::-1])])


@checked
def office(
    *,
    rng: np.random.Generator,
    rooms: Annotated[Count, at_most(1000)] = 3,
    width: Annotated[Length, at_least(3)] = 4.0,
    depth: Annotated[Length, at_least(3.5)] = 4.0,
    corridor: Length = 2.0,
) -> Array:
    """A corridor along x with furnished rooms on both sides, doors standing open.

    The half of each room next to the corridor is left free for a robot; the corridor runs from
    `y = depth` to `y = depth + corridor`. Each door is in the middle of its room, so that a robot
    finds it, and its leaf stands open at an angle of its own.

    Parameters
    ----------
    rng : numpy.random.Generator
        Places the furniture and turns the doors.
    rooms : int
        Rooms on each side.
    width, depth : float
        Of each room, with the wall towards its neighbour; at least 3 m and 3.5 m.
    corridor : float
        Width of the corridor.

    Examples
    --------
    >>> office(rng=np.random.default_rng(1)).max(axis=(0, 1))
    array([12., 10.])
    """
    top = depth + corridor
    above = [(width * i, top, 0.0) for i in range(rooms)]
    below = [(width * (i + 1), depth, np.pi) for i in range(rooms)]
    walls = [transform(pose, _furnish(width, depth, rng)) for pose in above + below]
    ends = [polyline([(x, depth), (x, top)]) for x in (0.0, width * rooms)]
    return np.round(np.concatenate([*walls, *ends]), 6)


def _furnish(width: float, depth: float, rng: np.random.Generator) -> Array:
    """A room above its stretch of corridor wall, which runs from (0, 0) to (width, 0)."""
    door_start, door_end = (width - DOOR) / 2, (width + DOOR) / 2
    near, far = THICKNESS / 2, width - THICKNESS / 2
    inner = [(door_start, THICKNESS), (near, THICKNESS), (near, depth), (far, depth)]
    outline = [(0, 0), (door_start, 0), *inner, (far, THICKNESS), (door_end, THICKNESS)]
    opening = rng.uniform(np.radians(70), np.radians(110))
    leaf = DOOR * np.array([np.cos(opening), np.sin(opening)])
    hinge = np.array([door_start, THICKNESS])
    walls = [polyline([*outline, (door_end, 0), (width, 0)]), polyline([hinge, hinge + leaf])]
    return np.concatenate([*walls, *_furniture(near, far, depth, rng)])


def _furniture(near: float, far: float, depth: float, rng: np.random.Generator) -> list[Array]:
    """A desk at the back wall, a cupboard at a side wall, a chair at any angle."""
    desk, cupboard = rng.uniform(1.0, 1.6), rng.uniform(0.6, depth / 2 - 0.75)
    at = rng.uniform(near + desk / 2 + 0.3, far - desk / 2 - 0.3)
    side = near + 0.2 if rng.random() < 0.5 else far - 0.2
    chair = (at, depth - rng.uniform(1.1, 1.4), rng.uniform(0, np.pi / 2))
    return [
        box(desk, 0.7, (at, depth - 0.35, 0)),
        box(0.4, cupboard, (side, depth / 2 + cupboard / 2, 0)),
        box(0.45, 0.45, chair),
    ]
