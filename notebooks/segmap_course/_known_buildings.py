"""Simulated buildings whose walls are known, driven through with poses that are off."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import NamedTuple

import numpy as np

from segmap.arrays import Array
from segmap.extraction import build_map
from segmap.scans import Log
from segmap.segments import SegmentMap
from segmap.simulation import (
    SICK_LMS200,
    OdometryNoise,
    Sensor,
    box,
    city,
    corridor_loop,
    drive,
    office,
    polyline,
    simulate,
)

#: Standard deviations of the poses, metres -> radians of heading. Drift is a running mean over some
#: 20 scans, with a little white noise.
NOISES = {"0": 0.0, "0.01": np.radians(0.15), "0.02": np.radians(0.3), "0.03": np.radians(0.5)}


class Known(NamedTuple):
    """The walls of a building, the map at the true poses, and the map whose poses are off."""

    walls: Array
    true: SegmentMap
    map: SegmentMap


def known_building(
    name: str, noise: str = "0.02", seed: int = 0, *, sensor: Sensor = SICK_LMS200
) -> Known:
    """A drive through floor, office, city, corridor_loop, hall or diagonal, its poses then spoilt.

    Noise is that of the places, "0", "0.01", "0.02" or "0.03" metres, with headings that are off by
    0, 0.15, 0.3 or 0.5 degrees, or "drift". Segments of 0.10 m and more. These are the maps on
    which `benchmarks/bench_walls.py` judges all methods.

    Examples
    --------
    >>> [len(part) for part in known_building("floor")]
    [13, 476, 476]
    """
    walls, _ = buildings()[name]
    log = driven(name, seed, sensor)
    assert log.truth is not None
    poses = noisy(log.truth, noise, np.random.default_rng(1000 + seed))
    maps = [build_map(log, path, keep_points=True) for path in (log.truth, poses)]
    return Known(walls, *(map.filtered(0.10) for map in maps))


@cache
def driven(name: str, seed: int, sensor: Sensor) -> Log:
    """A drive through one of the buildings, its poses true."""
    walls, path = buildings()[name]
    return simulate(walls, path, sensor=sensor, rng=np.random.default_rng(seed))


@cache
def buildings() -> dict[str, tuple[Array, Array]]:
    """The walls of each building, and the poses of a drive through it."""
    floor = [box(12, 8, (6, 4, 0)), box(1, 0.8, (6, 5.9, 0))]
    floor += [
        polyline(ends)
        for ends in (
            [(4, 0), (4, 3)],
            [(4, 4), (4, 8)],
            [(8, 8), (8, 5)],
            [(8, 4), (8, 0)],
            [(9, 2), (11, 3.2)],
        )
    ]
    way = [(2, 3.5), (6, 3.5), (10, 4.5), (10, 7), (10.5, 1), (6, 2), (6, 7), (2, 6.5), (2, 1)]
    rooms = [(1, 5), *((x, y) for x in (2, 6, 10) for y in (5, 7.6, 5, 2.4, 5)), (11, 5)]
    square = [(1.5, 1.5), (12.5, 1.5), (12.5, 12.5), (1.5, 12.5)]
    round_way = [(1, 1), (17, 1), (17, 9), (1, 9)]
    wide = np.radians(30)
    return {
        "floor": (np.concatenate(floor), drive(way, step=0.6, turn=np.radians(20))),
        "office": (
            office(rng=np.random.default_rng(66), rooms=3),
            drive([*rooms, *rooms[-2::-1]], step=0.8, turn=np.radians(45)),
        ),
        "city": (
            city(1, 1, rng=np.random.default_rng(5), block=8, street=3),
            drive([*square, *square, square[0]], step=0.6, turn=wide),
        ),
        "corridor_loop": (
            corridor_loop(18, 10),
            drive([*round_way, *round_way, round_way[0]], step=0.6, turn=wide),
        ),
        "hall": hall(),
        "diagonal": diagonal(),
    }


def hall() -> tuple[Array, Array]:
    """A hall with four pillars and six niches, 12 to 40 cm deep."""
    bottom_side = [(0, 0), (1.5, 0), (1.5, -0.25), (2.5, -0.25), (2.5, 0)]
    bottom_side += [(6, 0), (6, -0.12), (7.2, -0.12), (7.2, 0), (10, 0)]
    right_side = [(10, 2.5), (10.4, 2.5), (10.4, 3.7), (10, 3.7), (10, 7)]
    top_side = [(8, 7), (8, 7.25), (7, 7.25), (7, 7), (4, 7), (4, 7.12), (3, 7.12), (3, 7), (0, 7)]
    left_side = [(0, 5.5), (-0.3, 5.5), (-0.3, 4.5), (0, 4.5)]
    places = [(3, 2.2, 0), (3, 4.8, 0), (7, 2.2, np.pi / 4), (7, 4.8, 0.35)]
    pillars = [box(0.4, 0.4, place) for place in places]
    way = [(1.2, 1.2), (5, 1.1), (8.7, 1.2), (8.8, 3.5), (8.7, 5.8), (5, 5.9), (1.2, 5.8)]
    way += [(1.2, 3.5), (5, 3.5), (8.7, 3.4)]
    outline = polyline([*bottom_side, *right_side, *top_side, *left_side], closed=True)
    return np.concatenate([outline, *pillars]), drive(way, step=0.6, turn=np.radians(30))


def diagonal() -> tuple[Array, Array]:
    """Three rooms with doors of a metre; few walls are parallel, and a box stands at an angle."""
    outline = polyline([(0, 0), (7, 0), (10, 3), (10, 7.5), (7.5, 9), (3, 9), (0, 6)], closed=True)
    middle, inner = np.array([6.0, 4.5]), []
    for end, low, high in (((4, 0), 0.35, 0.55), ((10, 5.5), 0.4, 0.62), ((0, 5), 0.4, 0.56)):
        near, far = (np.round(middle + (end - middle) * share, 6) for share in (low, high))
        inner += [polyline(np.array(ends)) for ends in ((middle, near), (far, end))]
    way = [(1.5, 1.5), (3, 3), (5.1, 2.475), (7, 2), (8.5, 3.5), (8.05, 5.01), (8, 6.8), (5.5, 6)]
    way += [(3.1, 6.6), (3.1, 4.74), (2, 3), (1.2, 4)]
    walls = np.concatenate([outline, *inner, box(0.8, 0.5, (4.5, 7.5, 0.5))])
    return walls, drive(way, step=0.6, turn=np.radians(30))


def noisy(truth: Array, noise: str, rng: np.random.Generator) -> Array:
    """The poses with white noise, or with drift."""
    white = rng.normal(size=(len(truth), 3))
    if noise != "drift":
        return truth + white * (float(noise), float(noise), NOISES[noise])
    keep = np.exp(-1 / 20)
    slow = rng.normal(size=(len(truth), 3))
    for k in range(1, len(slow)):
        slow[k] = keep * slow[k - 1] + np.sqrt(1 - keep**2) * slow[k]
    return truth + slow * (0.02, 0.02, np.radians(0.3)) + white * (0.005, 0.005, np.radians(0.1))


def equal_offices(seed: int = 3) -> Log:
    """A drive through three offices in a row, 4 m apart, the same in every detail.

    The laser sees 4 m, and the wheels are bad. The robot visits each and returns to the first.

    Examples
    --------
    >>> equal_offices()
    Log('simulated', 211 scans, odometry, truth)
    """
    one = office(rng=np.random.default_rng(1), rooms=1)
    fronts = [one[:-2] + (4 * k, 0) for k in range(3)]
    walls = np.concatenate([*fronts, one[-2:-1], one[-1:] + (8, 0)])
    visits = [stop for x in (2, 6, 10) for stop in ((x, 5), (x, 7.4), (x, 5))]
    way = drive([(1, 5), *visits, (11, 5), (1, 5), (2, 5), (2, 7.4)], step=0.3, turn=0.35)
    wheels = OdometryNoise(turn_bias=0.05, turn_noise=0.05, heading_noise=0.02)
    eye, rng = replace(SICK_LMS200, max_range=4.0), np.random.default_rng(seed)
    return simulate(walls, way, sensor=eye, odometry_noise=wheels, rng=rng)
