"""Planted false loops: places that look alike are not taken for each other, true returns close.

A loop is false where it is wrong by more than half a metre and by more than three of the standard
deviations that it claims: along a hall without features a loop claims to know nothing.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest

from segmap.alignment import pose_graph
from segmap.angles import wrap
from segmap.poses import between, transform
from segmap.scans import Log
from segmap.simulation import (
    OdometryNoise,
    Sensor,
    box,
    drive,
    polyline,
    rectangular_room,
    simulate,
)

LASER = Sensor("laser", 181, -np.pi / 2, np.pi / 180, max_range=8.0, sigma=0.01)
#: A lap ends some metres off.
WHEELS = OdometryNoise(turn_bias=0.03, turn_noise=0.03, heading_noise=0.01, distance_noise=0.1)
DEPTH, WIDTH = 13.0, 2.0
DOOR, THICK = 0.9, 0.15
#: What stands on a wall that is uneven, metres.
WIDTHS, DEPTHS = (0.7, 1.6), (-0.3, 0.6)
#: A loop is false where it is wrong by more, metres and standard deviations.
FALSE, CLAIMED = 0.5, 3.0
#: A return: a key frame so near an older pose, seen from the same heading, after so long a path.
NEAR, TURN, AFTER = 1.0, np.radians(20), 10.0
#: Returns along so much path are one place, metres.
PLACE = 5.0


def ring(rng: np.random.Generator, length: float) -> np.ndarray:
    """A corridor round a block; its first leg has doors alike on both sides."""
    outer = rectangular_room(length, DEPTH)
    inner = box(length - 2 * WIDTH, DEPTH - 2 * WIDTH, (length / 2, DEPTH / 2, 0))[:, ::-1]
    walls = [doors(outer[0]), doors(inner[0]), outer[2:3], inner[2:3]]
    return np.concatenate([*walls, *(uneven(w, rng) for w in (*outer[1::2], *inner[1::2]))])


def uneven(wall: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Something else in every four metres to its right or left: no two places look alike."""
    reach = float(np.hypot(*(wall[1] - wall[0])))
    count = int(reach // 4)
    half = rng.uniform(*WIDTHS, count) / 2
    begin = reach / count * np.arange(count) + rng.uniform(0.3, reach / count - 2 * half - 0.3)
    along = np.stack([begin, begin, begin + 2 * half, begin + 2 * half], -1).ravel()
    deep = rng.uniform(*DEPTHS, count)
    right = np.stack([0 * deep, deep, deep, 0 * deep], -1).ravel()
    line = polyline(np.stack([np.r_[0, along, reach], -np.r_[0, right, 0]], -1))
    return transform((*wall[0], np.arctan2(*(wall[1] - wall[0])[::-1])), line)


def doors(wall: np.ndarray) -> np.ndarray:
    """A door after every pier that is as wide as a door, from end to end."""
    reach = float(np.hypot(*(wall[1] - wall[0])))
    first = np.arange(DOOR, reach - 2 * DOOR, 2 * DOOR)
    along = (first[:, None] + (0, 0, DOOR, DOOR)).ravel()
    right = np.tile([0, THICK, THICK, 0], len(first))
    line = polyline(np.stack([np.r_[0, along, reach], -np.r_[0, right, 0]], -1))
    return transform((*wall[0], np.arctan2(*(wall[1] - wall[0])[::-1])), line)


def drive_through(length: float) -> Log:
    """Two laps and a half; the second passes what looks alike with the errors of the first."""
    rng, end = np.random.default_rng(1), length - 1
    lap = [(1, 1), (end, 1), (end, DEPTH - 1), (1, DEPTH - 1)]
    path = [(12, DEPTH - 1), (1, DEPTH - 1), *lap, *lap]
    path = drive(path, step=0.3, turn=np.radians(15))
    return simulate(ring(rng, length), path, sensor=LASER, rng=rng, odometry_noise=WHEELS)


class Verdict(NamedTuple):
    false: int  # loops that are wrong by more than half a metre and three of their own deviations
    places: int  # returns, a place in every five metres of way
    closed: int  # of these, with a loop


def verdict(log: Log) -> Verdict:
    graph = pose_graph(log).graph
    ends, information = graph.edges[graph.loop], graph.information[graph.loop]
    left = between(log.truth[ends[:, 0]], log.truth[ends[:, 1]]) - graph.relative[graph.loop]
    left[:, 2] = wrap(left[:, 2])
    sure = np.sqrt(np.einsum("ni,nij,nj->n", left, information, left)) > CLAIMED
    far = np.hypot(left[:, 0], left[:, 1]) > FALSE
    return Verdict(int((far & sure).sum()), *returns(log.truth, np.unique(graph.edges), ends))


def returns(truth: np.ndarray, keys: np.ndarray, loops: np.ndarray) -> tuple[int, int]:
    """Places that are seen again, and those of them where a loop is closed."""
    path = np.r_[0, np.cumsum(np.hypot(*np.diff(truth[:, :2], axis=0).T))]

    def is_back(k: int) -> bool:
        left = between(truth[k], truth[path < path[k] - AFTER])
        near = np.hypot(left[:, 0], left[:, 1]) < NEAR
        return bool(np.any(near & (np.abs(left[:, 2]) < TURN)))

    back = np.array([is_back(k) for k in keys])
    place = (path[keys] / PLACE).astype(int)
    seen, ended = set(place[back]), {int(path[k] / PLACE) for k in loops.max(1, initial=0)}
    return len(seen), len(seen & ended)


#: Teeth of a round hall, degrees from one to the next, and its radius and their depth, metres.
PITCH, RADIUS, TEETH = 8.0, 5.0, 0.3


def turning_in_a_hall_of_teeth(seed: int, step: float) -> Log:
    """A robot turns on the spot where a turn by 8 degrees shows the same walls again."""
    at, count = np.radians(np.arange(0, 360, PITCH / 2)), round(400 / step)
    far = np.where(np.arange(len(at)) % 2, RADIUS, RADIUS + TEETH)
    walls = polyline(np.stack([far * np.cos(at), far * np.sin(at)], -1), closed=True)
    k = np.arange(count)
    path = np.stack([0.05 * np.cos(k), 0.05 * np.sin(k), wrap(np.radians(step) * k)], -1)
    laser, rng = replace(LASER, max_range=12.0), np.random.default_rng(seed)
    return simulate(walls, path, sensor=laser, rng=rng, odometry_noise=OdometryNoise())


@pytest.mark.parametrize("step", [20.0, 30.0])
@pytest.mark.parametrize("seed", [1, 2])
def test_where_a_turn_fits_as_well_the_odometry_has_its_word(seed, step):
    """Catches a scan that is turned back, by 8 to 40 degrees, to where it sees nothing new.

    Of half a round a turn of 30 degrees shows a sixth that no scan has seen: there the true heading
    fits less than a false one, though the odometry errs by 3 degrees at most. Where it errs by more
    than half the pitch, nothing tells.
    """
    log = turning_in_a_hall_of_teeth(seed, step)
    steps = [between(p[:-1], p[1:])[:, 2] for p in (log.truth, log.odometry, pose_graph(log).poses)]
    wheels, found = (np.degrees(np.abs(wrap(each - steps[0]))) for each in steps[1:])
    assert (wheels < PITCH / 2).mean() > 0.9
    assert found[wheels < 3].max() < 1


def test_entry_points_that_repeat_close_no_false_loop():
    """A lap and a half: the doors come again with the odometry metres off."""
    found = verdict(drive_through(24.0)[:415])
    assert found.false == 0
    assert found.places >= 5
    assert found.closed >= found.places - 1
