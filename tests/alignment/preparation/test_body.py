"""Beams that see the robot itself, or people who go along: they are left out, and walls are not."""

from dataclasses import replace
from functools import cache

import alignment_logs as logs
import numpy as np
import pytest

from segmap import load
from segmap.alignment import pose_graph, position_errors, prepared
from segmap.poses import compose
from segmap.scans import LaserScan, Log
from segmap.scans.causes import Cause
from segmap.simulation import (
    SICK_LMS200,
    URG_04LX,
    OdometryNoise,
    Sensor,
    box,
    cast_rays,
    drive,
    simulate,
)

#: Its first beam looks ahead, so what is behind the robot lies in the middle of its scans.
SPINS = Sensor("spins", 360, 0.0, np.radians(1), max_range=12.0, min_range=0.12, sigma=0.01)
SENSORS = {"around": logs.AROUND, "spins": SPINS, "ahead": SICK_LMS200, "three quarters": URG_04LX}
PATHS = {
    "rooms": logs.ROOMS,
    "corridor": drive([(2, 1.1), (50, 1.1)], step=0.25),
}
WALLS = {
    "rooms": logs.OFFICE,
    # 60 m long and 2.2 m wide, with a door frame every 7 m
    "corridor": np.concatenate(
        [box(60, 2.2, (30, 1.1, 0)), [[(x, 2.2), (x, 2.0)] for x in range(3, 60, 7)]]
    ),
}
#: Directions of four posts, degrees; each is 11 degrees wide.
POSTS = (-80.0, -40.0, 40.0, 80.0)


@cache
def driven(place: str = "rooms", sensor: str = "around") -> Log:
    """A drive with the odometry of good wheels."""
    rng = np.random.default_rng(11)
    return simulate(
        WALLS[place], PATHS[place], sensor=SENSORS[sensor], rng=rng, odometry_noise=OdometryNoise()
    )


def from_posts(scan: LaserScan) -> np.ndarray:
    """How far each beam looks beside the next post, `(n,)`, degrees."""
    off = np.degrees(scan.angles)[:, None] - POSTS
    return np.abs((off + 180) % 360 - 180).min(1)


def with_posts(log: Log, at: float = 0.25, jitter: float = 0.003, factor: float = 1.0) -> Log:
    """The log of a robot whose posts stand in each scan."""
    rng = np.random.default_rng(7)

    def blocked(scan: LaserScan) -> LaserScan:
        off = from_posts(scan)
        ranges = np.where(off < 5.5, at + jitter * rng.standard_normal(len(scan)), scan.ranges)
        return replace(scan, ranges=ranges * factor, max_range=scan.max_range * factor)

    return replace(log, scans=tuple(map(blocked, log)))


def with_people(log: Log, walls: np.ndarray, *feet: tuple[float, float], sway: float = 0.0) -> Log:
    """The log of a robot beside which people walk."""
    rng = np.random.default_rng(5)

    def seen(scan: LaserScan, pose: np.ndarray) -> LaserScan:
        at = [compose(pose, [x, y, 0.0] + sway * rng.standard_normal(3)) for x, y in feet]
        people = np.concatenate([walls, *(box(0.4, 0.3, place) for place in at)])
        ranges = cast_rays(people, pose, scan.angles, max_range=scan.max_range)
        return replace(scan, ranges=ranges + 0.01 * rng.standard_normal(len(ranges)))

    assert log.truth is not None
    return replace(log, scans=tuple(map(seen, log, log.truth)))


def masked(log: Log) -> np.ndarray:
    """Which beams are left out in all scans, `(n,)`."""
    return np.all([np.isnan(scan.ranges) for scan in log], 0)


def body(log: Log) -> list[float]:
    """How many beams are told to see the robot, or people."""
    return [finding.value for finding in log.causes if finding.cause is Cause.BODY]


@pytest.mark.parametrize("wheels", [True, False], ids=["wheels", "carried"])
@pytest.mark.parametrize("sensor", SENSORS)
def test_posts_are_left_out(sensor, wheels):
    """Catches a mask beside the posts, or that leaves the half beams at one side of them, walls
    that go with them, and odometry that it leans on."""
    log = with_posts(driven(sensor=sensor))
    found = prepared(log if wheels else logs.without_odometry(log))
    degrees = from_posts(log[0])
    posts, gone = degrees < 5.5, masked(found)
    beside = np.roll(posts, 1) | np.roll(posts, -1)
    assert gone[posts | beside].all() and not gone[degrees > 8].any()
    (finding,) = (finding for finding in found.causes if finding.cause is Cause.BODY)
    assert not finding.doubtful and abs(finding.value - posts.sum()) <= 4
    assert f"{finding.value} of {len(posts)} beams see the robot itself" in str(finding)
    far = ~posts & (degrees > 8)
    kept = zip(found, log, strict=True)
    assert all(np.array_equal(a.ranges[far], b.ranges[far], equal_nan=True) for a, b in kept)


def test_posts_do_not_hold_a_drive_along_a_corridor():
    """Catches a drive of 48 m that has no length, with a map that is called good."""
    log = driven("corridor")
    found = pose_graph(prepared(with_posts(log)))
    assert log.truth is not None
    assert position_errors(found.poses, log.truth, best=True).max() < 1
    assert np.hypot(*np.diff(found.poses[[0, -1], :2], axis=0)[0]) > 46


def test_posts_are_kept_where_that_is_asked_for():
    """Catches an option that nobody reads, and walls that a body hides without a word."""
    log = with_posts(driven("corridor"))
    found = prepared(log, keep_body=True)
    assert not masked(found).any()
    assert not any(finding.doubtful for finding in found.causes if finding.cause is Cause.BODY)


def test_beams_may_vary_in_number_and_direction():
    """Catches columns of the first scan for all, and a first scan with a few beams."""
    rng = np.random.default_rng(3)

    def some(scan: LaserScan) -> LaserScan:
        kept = rng.random(len(scan)) > 0.1
        angles = scan.angles + rng.uniform(-0.2, 0.2) * np.radians(1)
        return replace(scan, ranges=scan.ranges[kept], angles=angles[kept])

    log = with_posts(driven())
    few = replace(log[0], ranges=log[0].ranges[:2], angles=log[0].angles[:2])
    found = prepared(replace(log, scans=(few, *(some(scan) for scan in log[1:]))))
    near = [scan.points()[np.hypot(*scan.points().T) < 0.3] for scan in found[1:]]
    assert body(found) and sum(map(len, near)) < 0.05 * 44 * len(log)


@pytest.mark.parametrize("sway", [0.0, 0.05])
def test_people_who_walk_along_bend_no_map(sway):
    """Catches people that hold the robot, whether they keep their distance or not."""
    feet = [(1.0, 0.7), (-0.9, -0.6)]
    log = with_people(driven(), WALLS["rooms"], *feet, sway=sway)
    found = pose_graph(prepared(log))
    assert (sway > 0 or body(found)) and log.truth is not None
    assert position_errors(found.poses, log.truth, best=True).max() < 0.1


def test_a_mask_leaves_out_what_lies_within():
    """Catches degrees, a wrap behind the laser, and a mask that an option before it turns over."""
    log = driven()
    degrees = np.degrees(log[0].angles)
    behind, ahead = np.radians([170, -170]), np.radians([-0.5, 30.5])
    gone = masked(prepared(log, mask=[behind, ahead])) & ~masked(log)
    assert np.array_equal(gone, (np.abs(degrees) > 169.9) | (degrees > -0.9) & (degrees < 30.9))
    turned = masked(prepared(log, mask=[ahead], clockwise=True))
    assert np.array_equal(turned, (degrees < 0.9) & (degrees > -30.9))
    for wrong, words in (([[0.1, 0.1]], "differ"), ([[170, 190]], "radians"), ([1], "shape")):
        with pytest.raises(ValueError, match=words):
            prepared(log, mask=wrong)


def stands() -> Log:
    """Nine tenths of the scans of one place, then a drive."""
    path = np.vstack([np.tile(PATHS["rooms"][0], (600, 1)), PATHS["rooms"][:60]])
    return simulate(
        WALLS["rooms"],
        path,
        sensor=logs.AROUND,
        rng=np.random.default_rng(2),
        odometry_noise=OdometryNoise(),
    )


def aside() -> Log:
    """Along a corridor with a laser that looks to the left."""
    rng, place = np.random.default_rng(11), (0.3, -0.2, np.pi / 2)
    return simulate(WALLS["corridor"], PATHS["corridor"], sensor=logs.AROUND, rng=rng,
                    odometry_noise=OdometryNoise(), sensor_pose=place)  # fmt: skip


WALLS_ONLY = {
    "laser aside along a corridor": aside,
    "spins along a corridor": lambda: driven("corridor", "spins"),
    "rooms": driven,
    "carried": lambda: logs.without_odometry(driven()),
    "along a corridor": lambda: driven("corridor"),
    "carried along a corridor": lambda: logs.without_odometry(driven("corridor")),
    "ahead": lambda: driven("corridor", "ahead"),
    "stands for long": stands,
    "stands": lambda: stands()[:300],
    "bundled corridor": lambda: load("corridor"),
    "bundled room": lambda: load("room"),
}


@pytest.mark.parametrize("name", WALLS_ONLY)
def test_walls_are_no_body(name):
    """Catches walls beside which the robot drives, or stands, that are taken for its body."""
    log = WALLS_ONLY[name]()
    assert not body(prepared(log))
