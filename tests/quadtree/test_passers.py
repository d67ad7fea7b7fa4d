"""People who walk through a simulated office, and a map that leaves them out."""

import numpy as np
import pytest

from segmap import LaserScan, Log, extraction, simulation
from segmap.poses import transform
from segmap.quadtree import without_passers
from segmap.segments import point_distance

PEOPLE, RADIUS = 10, 0.2


def walked(seed, people=PEOPLE):
    """A log of a robot in a corridor where people walk past it on both sides; and the walls."""
    rng = np.random.default_rng(seed)
    walls = simulation.office(rng=rng)
    path = simulation.drive([(1.0, 5.0), (11.0, 5.0)], step=0.1)
    y = 5 + rng.uniform(0.4, 0.7, people) * rng.choice([-1, 1], people)
    starts, steps = rng.uniform(0, 11, people), rng.uniform(0.1, 0.25, people)
    turn = np.linspace(0, 2 * np.pi, 9)
    ring = RADIUS * np.stack([np.cos(turn), np.sin(turn)], -1)
    scans = []
    for k in range(len(path)):
        at = np.stack([0.5 + (starts + k * steps) % 11, y], -1)
        circles = at[:, None] + ring
        moving = np.stack([circles[:, :-1], circles[:, 1:]], 2).reshape(-1, 2, 2)
        seen = simulation.simulate(
            np.concatenate([walls, moving]), path[k : k + 1],
            sensor=simulation.SICK_LMS200, rng=rng,
        )  # fmt: skip
        scans.append(seen[0])
    return Log("office", scans, path), walls


def met(log, walls):
    """How many beams met a wall, and how many something else."""
    ends = np.concatenate([transform(p, s.points()) for p, s in zip(log.truth, log, strict=True)])
    off = point_distance(ends[:, None], walls).min(1)
    return int((off < 0.06).sum()), int((off > 0.12).sum())


@pytest.mark.parametrize("seed", range(3))
def test_ten_people_are_left_out_and_the_walls_stay(seed):
    """Catches people who are kept, walls that grazing rays erase, and beams of other scans."""
    log, walls = walked(seed)
    found = without_passers(log, log.truth)
    (wall, people), (wall_left, people_left) = met(log, walls), met(found, walls)
    assert people > 4000 and people_left < 0.25 * people and wall_left > 0.99 * wall
    most = met(without_passers(log, log.truth, seen_through=0.3), walls)
    assert most[1] < people_left and most[0] < wall_left  # a larger share takes more of both
    before, after = (extraction.build_map(each, log.truth) for each in (log, found))
    assert 0 < len(after) < len(before)
    changed = [
        np.isfinite(a.ranges) & np.isfinite(b.ranges) for a, b in zip(log, found, strict=True)
    ]
    for both, a, b in zip(changed, log, found, strict=True):
        assert np.array_equal(a.ranges[both], b.ranges[both])


@pytest.mark.parametrize(("others", "left"), [(4, False), (3, True)])
def test_a_square_is_seen_through_by_four_fifths_of_its_rays(others, left):
    """The first beam, by one in five; those behind it, beams without end and all else stay."""
    person = LaserScan([2.05, np.inf, 1.05], [0.0, 0.1, 2.0], time=3.0, codes=np.arange(3))
    log = Log("it", [person, *[LaserScan([4.05], [0.0])] * others, person])
    poses = np.zeros((len(log), 3))
    poses[-1] = np.nan
    found = without_passers(log, poses)
    np.testing.assert_array_equal(found[0].ranges, [2.05 if left else np.nan, np.inf, 1.05])
    assert found[0].time == 3 and found[0].codes.tolist() == [0, 1, 2] and found[-1] is person
    assert [scan.ranges[0] for scan in found[1:-1]] == [4.05] * others
    assert np.isfinite(without_passers(log, poses, seen_through=0.1)[0].ranges[0])


def test_none_is_lost_where_nobody_walks_and_unknown_poses_are_kept():
    log, _ = walked(1, people=0)
    poses = log.truth.copy()
    poses[:5] = np.nan
    found = without_passers(log, poses)
    assert all(found[k] is log[k] for k in range(5))
    kept, had = (sum(int(s.valid.sum()) for s in each) for each in (found, log))
    assert kept > 0.98 * had


@pytest.mark.parametrize("others", [0.0, 9.0, np.nan])
def test_whoever_met_him_and_whatever_the_other_beams_are(others):
    """A person in the way of three scans of 21, the last one too, behind beams that met nothing.

    Catches a last scan that is left out, and beams that are counted among the valid ones, which
    are fewer than those with a finite range.
    """
    wall = LaserScan([others, 4.05, others, 3.05], [1.0, 0.0, 2.0, 3.0], max_range=8.0)
    person = LaserScan([others, 2.05, others, 3.05], [1.0, 0.0, 2.0, 3.0], max_range=8.0)
    log = Log("it", [person if k in (0, 10, 20) else wall for k in range(21)])
    found = without_passers(log, np.zeros((21, 3)))
    for k, scan in enumerate(found):
        seen = np.nan if k in (0, 10, 20) else 4.05
        np.testing.assert_array_equal(scan.ranges, [others, seen, others, 3.05])
        assert log[k].ranges[1] in (2.05, 4.05)


@pytest.mark.parametrize(("angle", "left"), [(0.03, False), (0.06, True)])
def test_rays_that_see_through_pass_within_a_decimetre(angle, left):
    """Catches squares of another side: six centimetres beside a leg are seen through its square."""
    scans = [LaserScan([2.05], [0.0]), *[LaserScan([4.05], [angle])] * 20]
    found = without_passers(Log("it", scans), np.tile([0.0, 0.02, 0.0], (21, 1)))
    assert np.isfinite(found[0].ranges[0]) == left


@pytest.mark.parametrize("column", range(3))
def test_a_scan_whose_pose_is_half_known_is_kept_as_it_is(column):
    """Catches a scan that is used where any part of its pose is known."""
    person, wall = LaserScan([2.05], [0.0]), LaserScan([4.05], [0.0])
    poses = np.zeros((22, 3))
    poses[1, column] = np.nan
    found = without_passers(Log("it", [person, person, *[wall] * 20]), poses)
    assert np.isnan(found[0].ranges).all() and found[1] is person
