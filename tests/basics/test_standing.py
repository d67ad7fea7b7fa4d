"""Scans of a robot that stands: what they add to a map, and what is told."""

import numpy as np
import pytest

from segmap import build_map, load
from segmap.alignment import pose_graph
from segmap.poses import compose
from segmap.scans import LaserScan, Log
from segmap.scans.causes import Cause
from segmap.scans.motion import repeats_place
from segmap.simulation import SICK_LMS200, drive, simulate, square_room


def looks(count: int, path=None) -> Log:
    """A room of 8 m seen again and again with 2 cm of noise."""
    poses = np.tile([3.0, 4.0, 0.3], (count, 1)) if path is None else path
    sensor, rng = SICK_LMS200, np.random.default_rng(3)
    return simulate(square_room(8), poses, sensor=sensor, rng=rng)


def test_more_looks_from_one_place_add_nothing():
    """Catches a map that grows while the robot stands, and a stay that is thrown away whole."""
    many = looks(300)
    few = many[:20]
    assert len(build_map(many, many.truth)) == len(build_map(few, few.truth)) > 20
    found = pose_graph(many)
    (told,) = (cause for cause in found.causes if cause.cause is Cause.STANDS)
    assert told.value == 280 and not told.doubtful
    assert found.verdict.words.startswith("NOT CHECKED: one look; nothing confirms it; 300 of 300")


def test_a_message_that_comes_twice_counts_once():
    """Catches equal scans that are drawn one beside the other."""
    log = load("room")
    twice = log[np.repeat(np.arange(len(log)), 2)]
    once = build_map(log, log.truth)
    assert np.array_equal(build_map(twice, twice.truth).segments, once.segments)


def test_a_robot_that_moves_is_drawn_whole():
    """Catches a robot that creeps, one that turns on the spot, and a second visit."""
    creeping = looks(60, drive([(2, 2), (2.3, 2)], step=0.005))
    assert not repeats_place(creeping, creeping.truth).any()
    turning = looks(60, np.column_stack([np.full((60, 2), 3.0), np.radians(0.15) * np.arange(60)]))
    assert not repeats_place(turning, turning.truth).any()
    log = looks(50)
    away = np.array([1.0, 0.0, 0.0])
    poses = np.vstack([log.truth[:15], compose(log.truth[15:35], away), log.truth[35:]])
    assert not repeats_place(log, poses).any()


@pytest.mark.parametrize("other", ["beams", "view", "nothing"])
def test_what_looks_otherwise_is_drawn(other):
    """Catches poses that are equal by mistake: a second laser, or another building."""
    log = looks(40)
    wall = log[0].ranges
    changed = {"beams": wall[:90], "view": wall + 1.0, "nothing": np.full_like(wall, np.inf)}[other]
    last = LaserScan(changed, log[0].angles[: len(changed)], 99.0)
    mixed = Log("mixed", [*log, last])
    mask = repeats_place(mixed, np.vstack([log.truth, log.truth[:1]]))
    assert mask[:40].sum() == 20 and not mask[40]
