"""Exercises on the sensor: its beams and its characters."""

from __future__ import annotations

from typing import Any

import numpy as np

from segmap.arrays import Array
from segmap.poses import transform
from segmap.readers import half_turn
from segmap.sensors import checksum, decode, encode
from segmap.simulation import cast_rays

from ..literal.scip import distances_of
from ._answers import Cases
from ._exercise import Exercise, Rng, anywhere, changed, edited


# ------------------------------------------------------------------------------ beams
def _numbers_of_beams(rng: Rng) -> Cases:
    few, many = rng.integers(3, 10), rng.integers(50, 400)
    numbers = (2 * few, 2 * few + 1, 2 * many, 2 * many + 1)
    return {f"{n} beams": (int(n),) for n in numbers}


check_beam_angles = Exercise(
    "beam_angles(n) -> (n,) radians: directions of the n beams of a sensor that sees half a turn",
    half_turn,
    _numbers_of_beams,
    {
        "180 or 360 beams leave the end point out: their step is exactly 1 or 0.5 degrees": (
            lambda n: np.linspace(-np.pi / 2, np.pi / 2, n)
        ),
        "181 or 361 beams include both ends: the last one points to +90 degrees": (
            lambda n: np.linspace(-np.pi / 2, np.pi / 2, n, endpoint=False)
        ),
        "0 is straight ahead: the first beam looks to the right, at -90 degrees": (
            lambda n: half_turn(n) + np.pi / 2
        ),
        "the library works in radians: convert the degrees": changed(half_turn, np.degrees),
        "angles count counter-clockwise, from the right (-90 degrees) to the left": (
            changed(half_turn, np.negative)
        ),
        "the step depends on n: half a turn has 180 steps of 1 degree, or 360 of half a degree": (
            lambda n: np.radians(np.arange(n) - 90)
        ),
        "odd numbers include both ends, even ones leave the last out; here it is exchanged": (
            lambda n: np.linspace(-np.pi / 2, np.pi / 2, n, endpoint=n % 2 == 0)
        ),
        "the beams go from -90 to 90 degrees, half a turn, not from -180 to 180": (
            lambda n: 2 * half_turn(n)
        ),
    },
)


def _walls_ahead(rng: Rng) -> Cases:
    """A wall ahead, beside the beam, behind the robot and along the beam."""
    robot = anywhere(rng, -40, 40) * (0.2, 0.2, 1)
    away, half = rng.uniform(1, 4), rng.uniform(0.5, 1.5)
    wall = np.array([(away, -half), (away, half * rng.uniform(0.7, 1.3))])
    leaning = wall + [(rng.uniform(0.1, 0.5), 0), (0, 0)]
    inside, outside = 0.5 * np.arctan(half / away), np.arctan(1.5 * half / away) + 0.1
    return {
        words: (transform(robot, ends)[:: rng.choice([-1, 1])], robot, float(beam))
        for words, ends, beam in (
            ("a wall straight ahead", wall, 0.0),
            ("the middle of a wall", np.array([(away, -half), (away, half)]), 0.0),
            ("a beam to the left", wall, inside),
            ("a leaning wall, a beam to the right", leaning, -inside),
            ("a wall close ahead", wall * (0.1, 1), 0.0),
            ("a wall behind the robot", wall * (-1, 1), 0.0),
            ("a beam that passes beside the wall", wall, outside),
            ("a beam along the wall", wall, np.pi / 2),
        )
    }


def _cast_ray(wall: Array, pose: Array, angle: float) -> float:
    """Range to a wall, of which the mistakes change a part."""
    beam = np.array([np.cos(pose[2] + angle), np.sin(pose[2] + angle)])
    start, along = wall[0] - pose[:2], wall[1] - wall[0]
    across = beam[0] * along[1] - beam[1] * along[0]
    if abs(across) < 1e-12:
        return np.inf
    distance = (start[0] * along[1] - start[1] * along[0]) / across
    share = (start[0] * beam[1] - start[1] * beam[0]) / across
    return float(distance) if distance > 0 and 0 <= share <= 1 else np.inf


def _square_to_the_wall(wall: Array, pose: Array, angle: float) -> float:
    (x, y), (dx, dy) = pose[:2] - wall[0], wall[1] - wall[0]
    along = _cast_ray(wall, pose, angle)
    return float(min(along, abs(dx * y - dy * x) / np.hypot(dx, dy)) if along < np.inf else np.inf)


check_cast_ray = Exercise(
    "cast_ray(wall, pose, angle) -> metres to the wall (2, 2) along the beam at `angle` radians "
    "from a robot at pose (3,); inf where it is not met",
    lambda wall, pose, angle: float(cast_rays([wall], pose, [angle])[0]),
    _walls_ahead,
    {
        "a beam goes one way only: a wall behind the sensor, at a negative range, is not met": (
            edited(_cast_ray, ("distance > 0 and ", ""))
        ),
        "a wall ends: the meeting point must lie between its end points": (
            edited(_cast_ray, (" and 0 <= share <= 1", ""))
        ),
        "two lines always meet somewhere: test that it is ahead, and between the end points": (
            edited(_cast_ray, ("distance > 0 and 0 <= share <= 1", "True"))
        ),
        "angles are radians already: sin and cos take them as they are": (
            lambda wall, pose, angle: _cast_ray(wall, np.radians(pose), np.radians(angle))
        ),
        "the beam's angle counts from straight ahead: add the robot's heading": (
            lambda wall, pose, angle: _cast_ray(wall, pose * (1, 1, 0), angle)
        ),
        "the beam starts at the robot: take its x and y from the wall's first": (
            lambda wall, pose, angle: _cast_ray(wall, pose * (0, 0, 1), angle)
        ),
        "the range is measured along the beam, not square to the wall": _square_to_the_wall,
        "angles count counter-clockwise: a beam at a positive angle looks to the left": (
            lambda wall, pose, angle: _cast_ray(wall, pose * (1, 1, -1), -angle)
        ),
        "where the wall is not met the answer is inf, not nan": (
            changed(_cast_ray, lambda found: np.nan_to_num(found, posinf=np.nan))
        ),
        "where the wall is not met the answer is inf, not 0: that would be a wall at the sensor": (
            changed(_cast_ray, lambda found: np.nan_to_num(found, posinf=0.0))
        ),
    },
)


# ------------------------------------------------------------------------- the protocol
def _blocks(rng: Rng) -> Cases:
    """Blocks that cut distances or do not, each with its sum, whole or with a wrong character."""

    def blocks(size: int, *wrong: int) -> tuple[Any, ...]:
        text = encode(rng.integers(0, 1 << 18, int(rng.integers(14, 20))), 3)
        cut = [text[i : i + size] for i in range(0, len(text), size)]
        lines = [block + checksum(block) for block in cut]
        for k in wrong:
            at, other = int(rng.integers(len(cut[k]))), int(rng.integers(1, 64))
            digit = (lines[k][at] - 0x30 + other) % 64 + 0x30
            lines[k] = lines[k][:at] + bytes([digit]) + lines[k][at + 1 :]
        return (lines,)

    size = int(rng.choice([7, 8, 10, 11]))
    return {
        "all blocks are right": blocks(64),
        "a wrong block that cuts two distances": blocks(size, 1),
        "the first block is wrong": blocks(size, 0),
        "two wrong blocks of whole distances": blocks(9, 1, 3),
        "every block is wrong": blocks(30, 0, 1),
        "no block": ([],),
    }


def _kept_distances(lines: list[bytes]) -> Array:
    text = b"".join(line[:-1] for line in lines)
    right = [checksum(line[:-1]) == line[-1:] for line in lines for _ in line[:-1]]
    whole = np.reshape(right, (-1, 3)).all(axis=1)
    return np.where(whole, decode(text, 3), np.nan)


def _of_right_blocks(lines: list[bytes]) -> Array:
    text = b"".join(line[:-1] for line in lines if checksum(line[:-1]) == line[-1:])
    return decode(text[: len(text) // 3 * 3], 3).astype(float)


check_kept_distances = Exercise(
    "kept_distances(blocks) -> (n,) millimetres, NaN for each distance of which a character lies "
    "in a block whose sum is wrong; blocks: list of bytes, each with its sum as last character",
    _kept_distances,
    _blocks,
    {
        "a wrong sum is an error in the chapter, which loses the whole scan: keep what lies in "
        "right blocks": distances_of,
        "a wrong block still has its place: without it all later distances belong to other beams": (
            _of_right_blocks
        ),
        "the last character of each block is its sum: where it is wrong, the block is": (
            lambda lines: decode(b"".join(line[:-1] for line in lines), 3).astype(float)
        ),
        "a distance may begin in a right block and end in a wrong one: all its three characters "
        "must be right": edited(_kept_distances, (".all(axis=1)", "[:, 0]")),
        "one right character is not enough: all three must lie in right blocks": (
            edited(_kept_distances, (".all(axis=1)", ".any(axis=1)"))
        ),
        "a distance that is not known is NaN, and not 0: 0 says that nothing was met": (
            changed(_kept_distances, np.nan_to_num)
        ),
        "right blocks keep their distances, also where another block is wrong": (
            edited(_kept_distances, ("np.where(whole,", "np.where(whole.all(),"))
        ),
        "millimetres are asked for, not metres": (
            changed(_kept_distances, lambda found: found / 1000)
        ),
    },
)
