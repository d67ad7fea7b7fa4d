"""Hidden cases of the exercises on poses, beams, the sensor, lines and alignment.

Each function draws the cases of the exercise of its name: one of every kind that catches a mistake,
with other numbers, and placed anywhere where the place does not matter.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from segmap.arrays import Array
from segmap.hokuyo import checksum
from segmap.poses import transform

Rng = np.random.Generator
Drawn = dict[str, tuple[Any, ...]]
#: The sensor's clock, milliseconds, starts again here.
WRAP = 1 << 24


# ------------------------------------------------------------------------------ poses
def pose(x: float, y: float, degrees: float) -> Array:
    """A pose (3,) from metres and degrees."""
    return np.array([x, y, np.radians(degrees)])


def at(place: Array, degrees: float) -> Array:
    """A pose (3,) from a place (2,) and degrees."""
    return np.append(place, np.radians(degrees))


def anywhere(rng: Rng, low: float = -180.0, high: float = 180.0) -> Array:
    """A pose within 5 m, with a heading between these degrees."""
    return at(rng.uniform(-5, 5, 2), rng.uniform(low, high))


def compose(rng: Rng) -> Drawn:
    """Turns within half a turn, and over it on both sides."""
    return {
        "a step ahead of a robot that looks left": (anywhere(rng, 60, 120), anywhere(rng, -20, 20)),
        "two turns that end beyond half a turn": (anywhere(rng, 120, 179), anywhere(rng, 70, 150)),
        "two turns clockwise, beyond half a turn": (
            anywhere(rng, -179, -120),
            anywhere(rng, -150, -70),
        ),
        "two small turns": (anywhere(rng, -60, 60), anywhere(rng, -60, 60)),
    }


def heading_between(rng: Rng) -> Drawn:
    """Both ways round, within half a turn and over it."""

    def way(before: float, turn: float, share: float) -> tuple[Any, ...]:
        after = (before + turn + 180) % 360 - 180
        return np.radians(before), np.radians(after), share

    begin, turn = rng.uniform(-70, 0), rng.uniform(20, 60)
    return {
        "a turn to the left": way(begin, turn, rng.uniform(0.1, 0.4)),
        "a turn to the right": way(begin, -turn, rng.uniform(0.1, 0.4)),
        "a turn to the left, beyond half a turn": way(170, turn, rng.uniform(0.8, 0.9)),
        "a turn to the right, beyond half a turn": way(-172, -turn, rng.uniform(0.6, 0.9)),
        "a turn to the right, not yet beyond half a turn": way(-150, -turn, rng.uniform(0.1, 0.2)),
    }


def edge_error(rng: Rng) -> Drawn:
    """A measured motion that is a little off, within half a turn and over it."""
    first, step = (
        anywhere(rng, -60, 60),
        at(rng.uniform(0.3, 2, 2), rng.uniform(20, 70)),
    )
    off = np.append(rng.uniform(-0.3, 0.3, 2), rng.uniform(-0.2, 0.2))
    over = at(rng.uniform(-2, 2, 2), rng.uniform(155, 175))
    back = at(rng.uniform(-2, 2, 2), rng.uniform(-175, -155))
    return {
        "a straight way": (first * (1, 1, 0), first * (1, 1, 0) + (1, 0, 0), np.array([1.2, 0, 0])),
        "a turn on the way": (first, anywhere(rng, -60, 60), step + off),
        "a turn over half a turn": (over, back, step * (1, 1, 0.3)),
        "a turn back over half a turn": (back, over, step * (1, 1, -0.3)),
    }


def carried(rng: Rng) -> Drawn:
    """A key frame that is shifted, turned, and turned over half a turn."""
    before, pose_ = anywhere(rng, -60, 60), anywhere(rng, -60, 60)
    shift, turn = rng.uniform(-1, 1, 2), np.radians(rng.uniform(20, 60))
    over = at(rng.uniform(-2, 2, 2), rng.uniform(120, 150))
    return {
        "a key frame that is shifted": (before, before + (*shift, 0), pose_),
        "one that turns where it stands": (before, before + (0, 0, turn), pose_),
        "one that is shifted and turned": (before, before + (*shift, -turn), pose_),
        "a turn over half a turn": (over, over + (*shift, 0.4), over + (0.5, -0.3, 0.5)),
    }


# ------------------------------------------------------------------- beams and the sensor
def beam_angles(rng: Rng) -> Drawn:
    """Odd and even numbers of beams, few and many."""
    few, many = rng.integers(3, 10), rng.integers(50, 400)
    numbers = (2 * few, 2 * few + 1, 2 * many, 2 * many + 1)
    return {f"{n} beams": (int(n),) for n in numbers}


def cast_ray(rng: Rng) -> Drawn:
    """A wall ahead, beside the beam, behind the robot and along the beam, placed anywhere."""
    robot, away, half = anywhere(rng), rng.uniform(1, 4), rng.uniform(0.5, 1.5)
    wall = np.array([(away, -half), (away, half * rng.uniform(0.7, 1.3))])
    leaning = wall + [(rng.uniform(0.1, 0.5), 0), (0, 0)]
    inside, outside = 0.5 * np.arctan(half / away), np.arctan(1.5 * half / away) + 0.1
    return {
        words: (transform(robot, ends)[:: rng.choice([-1, 1])], robot, float(beam))
        for words, ends, beam in (
            ("a wall straight ahead", wall, 0.0),
            ("a beam to the left", wall, inside),
            ("a leaning wall, a beam to the right", leaning, -inside),
            ("a wall behind the robot", wall * (-1, 1), 0.0),
            ("a beam that passes beside the wall", wall, outside),
            ("a beam along the wall", wall, np.pi / 2),
        )
    }


def with_sum(text: bytes) -> bytes:
    """A block as the sensor sends it."""
    return text + checksum(text)


def distances(rng: Rng) -> Drawn:
    """One block, blocks that cut distances, and none."""

    def blocks(size: int) -> tuple[Any, ...]:
        values = rng.integers(0, 1 << 18, int(rng.integers(8, 20)))
        digits = values[:, None] >> np.array([12, 6, 0]) & 63
        text = bytes((digits.ravel() + 0x30).tolist())
        return ([with_sum(text[i : i + size]) for i in range(0, len(text), size)],)

    return {
        "one block": blocks(64),
        "blocks that cut a distance": blocks(int(rng.choice([7, 8, 10, 11]))),
        "blocks of whole distances": blocks(9),
        "no block": ([],),
    }


def unwrapped(rng: Rng) -> Drawn:
    """A clock that does not wrap, one that does, and one that does more than once."""

    def stamps(start: int, most: int, count: int) -> tuple[Any, ...]:
        steps = rng.integers(most // 2, most, count)
        return ((start + np.cumsum(steps)) % WRAP,)

    start = int(rng.integers(1000, WRAP // 2))
    return {
        "a clock that does not wrap": stamps(start, 500, 5),
        "a clock that wraps": stamps(WRAP - 900, 600, 6),
        "a clock that wraps more than once": stamps(start, WRAP - 1, 6),
    }


# ------------------------------------------------------------------------------ lines
def axial_mean(rng: Rng) -> Drawn:
    """Lines on both sides of 0 degrees, a bundle elsewhere, and a single line."""

    def bundle(middle: float, count: int) -> tuple[Array]:
        return (np.radians((middle + rng.uniform(-25, 25, count)) % 180),)

    return {
        "two lines on both sides of 0 degrees": (
            np.radians([rng.uniform(1, 20), rng.uniform(150, 179)]),
        ),
        "three lines about 0 degrees": bundle(0, 3),
        "five lines about an upright one": bundle(90, 5),
        "four lines": bundle(rng.uniform(40, 140), 4),
        "one line": bundle(45, 1),
    }


def noisy_wall(degrees: float, through: Any, seed: int) -> Array:
    """Nine points of a 1 m wall, 3 cm off it at random."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    u, v = np.linspace(-0.5, 0.5, 9), np.random.default_rng(seed).normal(0, 0.03, 9)
    return np.array(through) + np.stack([u * c - v * s, u * s + v * c], 1)


def fit_line(rng: Rng) -> Drawn:
    """Walls anywhere, upright, and in line with the sensor."""
    seeds = rng.integers(0, 1 << 30, 4).tolist()
    along = rng.uniform(20, 70)
    return {
        "a wall": (noisy_wall(rng.uniform(10, 60), rng.uniform(2, 4, 2), seeds[0]),),
        "an upright wall": (noisy_wall(90, (rng.uniform(1, 4), 0), seeds[1]),),
        "a wall in line with the sensor": (
            noisy_wall(along, rng.uniform(0, 2) * transform(pose(0, 0, along), [1, 0]), seeds[2]),
        ),
        "a wall that leans to the left": (
            noisy_wall(rng.uniform(95, 170), rng.uniform(-4, -2, 2), seeds[3]),
        ),
    }


def farthest_point(rng: Rng) -> Drawn:
    """Points that are farthest to the left and to the right of chords of all directions."""

    def chord(side: float, degrees: float) -> tuple[Array]:
        count = int(rng.integers(4, 8))
        off = (
            rng.uniform(-0.3, 0.3, count) * (np.arange(count) > 0) * (np.arange(count) < count - 1)
        )
        off[rng.integers(1, count - 1)] = side * rng.uniform(0.5, 0.9)
        points = np.stack([np.linspace(0, rng.uniform(1, 3), count), off], 1)
        return (transform(anywhere(rng, degrees, degrees), points),)

    upright = chord(1, 0)[0][:, ::-1]
    return {
        "the farthest to the left": chord(1, rng.uniform(-30, 30)),
        "the farthest to the right": chord(-1, rng.uniform(-30, 30)),
        "a chord that stands upright": (upright - upright[0] * (1, 0),),
        "a steep chord": chord(-1, rng.uniform(70, 80)),
        "a steep chord, to the left": chord(1, rng.uniform(100, 110)),
    }


# -------------------------------------------------------------------------- alignment
def match_value(rng: Rng) -> Drawn:
    """Pairs that cover each other wholly, in part and not at all, placed anywhere."""
    off, far = rng.uniform(0.03, 0.15, 2)
    size, part = rng.uniform(2, 4), rng.uniform(0.2, 0.4)
    place, distance = anywhere(rng), float(rng.uniform(0.03, 0.1))
    long = [(0, 0), (size, 0)]
    short = [(part * size, off), (2 * part * size, off + far)]
    return {
        words: (transform(place, u), transform(place, v), distance)
        for words, u, v in (
            ("two parallel walls", long, [(0, off), (size, off)]),
            ("a short wall beside a long one", long, short),
            ("the same, exchanged", short, long),
            ("a leaning wall, end points exchanged", long, [(0.7 * size, 0.6), (0.3 * size, off)]),
            ("walls that overlap in part", long, [(part * size, off), ((1 + part) * size, off)]),
            ("walls beside each other", long, [(size + 0.5, off), (size + 2, off)]),
        )
    }


def lines_off(degrees: Any, offsets: Any, weights: Any) -> tuple[Array, Array, Array]:
    """Unit normals of lines at these angles, how far points lie off them, and their weights."""
    turn = np.radians(degrees)
    normals = np.stack([-np.sin(turn), np.cos(turn)], -1)
    return normals, np.array(offsets, float), np.array(weights, float)


def least_translation(rng: Rng) -> Drawn:
    """Lines of several directions, and corridors."""

    def lines(*degrees: float) -> tuple[Array, Array, Array]:
        count = len(degrees)
        return lines_off(degrees, rng.uniform(-0.1, 0.1, count), rng.uniform(1, 3, count))

    turn = rng.uniform(10, 80)
    return {
        "a corner": lines(turn, turn + 90, turn + rng.uniform(20, 70)),
        "two walls at a slant": lines(turn, turn + rng.uniform(60, 120)),
        "a corridor": lines(0, 0, 0),
        "a corridor that runs askew": lines(turn, turn),
        "walls of many directions": lines(*(turn + np.arange(0, 180, 36))),
    }


def room(dx: float, dy: float, degrees: float, turn: float = 0.0) -> tuple[Array, Array, Array]:
    """Points moved off three walls of a room, which is turned: the fourth is out of sight."""
    s = np.linspace(-1, 1, 5)
    feet = np.concatenate(
        [np.stack([3 + 0 * s, 2 * s], 1), np.stack([2 * s, 2 + 0 * s], 1), -np.stack([s, s**0], 1)]
    )
    normals = np.repeat([(1.0, 0.0), (0, 1), (0, -1)], 5, axis=0)
    feet, normals = transform((0, 0, turn), feet), transform((0, 0, turn), normals)
    return transform((dx, dy, np.radians(degrees)), feet), feet, normals


def corridor(dx: float, dy: float, turn: float = 0.0) -> tuple[Array, Array, Array]:
    """Points between two walls along x, turned."""
    s = np.linspace(0, 4, 5)
    feet = np.concatenate([np.stack([s, 0 * s + 1], 1), np.stack([s, 0 * s - 1], 1)])
    normals = np.repeat([(0.0, 1.0), (0, -1)], 5, axis=0)
    feet, normals = transform((0, 0, turn), feet), transform((0, 0, turn), normals)
    return feet + (dx, dy), feet, normals


def move_onto_walls(rng: Rng) -> Drawn:
    """Rooms seen shifted, turned, both, and a corridor: all of them askew."""
    dx, dy, off = rng.uniform(0.1, 0.3, 3)
    degrees, turn = rng.uniform(2, 5), rng.uniform(-np.pi, np.pi)
    return {
        "a room that is shifted": room(dx, -dy, 0, turn),
        "a room that is turned": room(0, 0, degrees, turn),
        "a room that is shifted and turned": room(-dx, dy, -degrees, turn),
        "a corridor, which does not fix the motion along it": corridor(dx, off, turn),
    }
