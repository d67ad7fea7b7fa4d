"""One building kept in five ways: bytes counted by hand, errors against walls that are known."""

import numpy as np
import pytest

from segmap import load
from segmap.experiments import along, judge, keep, storage_table, wall_errors
from segmap.simulation import (
    SICK_LMS200,
    URG_04LX,
    circular_room,
    drive,
    rectangular_room,
    simulate,
)

WALLS = rectangular_room(4.02, 3.02)
LOG = simulate(
    WALLS, drive([(1, 1), (3, 2)], step=0.2), sensor=URG_04LX, rng=np.random.default_rng(6)
)


def by_name(log=LOG, walls=WALLS, **options):
    ways = keep(log, log.truth, **options)
    return {judged.kept.name: judged for judged in judge(ways.kept, walls)}, ways.map


def test_bytes_are_those_of_the_arrays():
    """16 a point, 32 a segment, 8 a node, 8 a cell of the grid that just holds the walls."""
    found, map = by_name()
    count = sum(len(scan.points()) for scan in LOG)
    assert found["points"].kept.nbytes == 16 * count
    assert found["segments"].kept.nbytes == 32 * found["segments"].kept.parts
    assert found["reduced segments"].kept.nbytes == 32 * found["reduced segments"].kept.parts
    assert found["quadtree"].kept.nbytes == map.nbytes
    cells = np.rint(found["dense grid"].kept.points / 0.05).astype(int)
    rows, columns = np.ptp(cells, axis=0) + 1
    assert found["dense grid"].kept.nbytes == 8 * rows * columns
    assert 4 / 0.05 <= max(rows, columns) <= 4.3 / 0.05


def test_scans_without_a_pose_are_left_out():
    """Catches points that are nowhere and yet counted: 126 of the 225 scans of Malaga."""
    poses = LOG.truth.copy()
    poses[1::2] = np.nan
    found, expected = keep(LOG, poses).kept, keep(LOG[::2], LOG.truth[::2]).kept
    for some, same in zip(found, expected, strict=True):
        assert (some.parts, some.nbytes) == (same.parts, same.nbytes)
        assert np.array_equal(some.points, same.points)
    assert keep(LOG[:0], np.empty((0, 3))).kept[0].parts == 0


@pytest.mark.parametrize("poses", [None, LOG.truth[:-1], np.full((len(LOG), 3), np.inf)])
def test_poses_that_do_not_fit_the_log_are_refused(poses):
    with pytest.raises(ValueError, match=r"^poses must"):
        keep(LOG, poses)


def test_what_cannot_be_measured_is_refused():
    with pytest.raises(ValueError, match="walls must hold at least one"):
        wall_errors(np.zeros((1, 2)), [])
    with pytest.raises(ValueError, match="spacing must be positive"):
        along(WALLS, 0)


def test_the_order_that_the_chapter_shows():
    """Reduced segments are the smallest and nearest to straight walls; the tree beats the grid."""
    found, _ = by_name()
    size = {name: judged.kept.nbytes for name, judged in found.items()}
    assert size["reduced segments"] < size["segments"] < size["points"]
    assert size["quadtree"] < size["dense grid"]
    assert found["reduced segments"].error < found["points"].error < found["quadtree"].error
    assert min(judged.covered for judged in found.values()) > 0.9


def test_round_walls_are_where_segments_lose():
    """Counter-example: a wide strip swallows the bends of a round room, the tree does not care."""
    walls = circular_room(2.0)
    path = [(1.5, 2.0, 0.0), (2.5, 2.0, 3.0)]
    log = simulate(walls, path, sensor=SICK_LMS200, rng=np.random.default_rng(1))
    fine, _ = by_name(log, walls, tolerance=0.02)
    coarse, _ = by_name(log, walls, tolerance=0.10)
    assert coarse["reduced segments"].error > 2 * fine["reduced segments"].error
    assert coarse["quadtree"].error == fine["quadtree"].error


def test_errors_are_distances_from_the_nearest_wall():
    """Catches the distance from the line of a wall, and from its ends."""
    walls = [[(0, 0), (4, 0)], [(0, 0), (0, 3)]]
    points = np.array([(2, 0.5), (0.25, 2), (5, 0), (-3, -4)])
    np.testing.assert_allclose(wall_errors(points, walls), [0.5, 0.25, 1, 5])


@pytest.mark.parametrize("spacing", [0.01, 0.3, 2.0])
def test_samples_reach_both_ends(spacing):
    points = along(WALLS, spacing)
    for end in WALLS.reshape(-1, 2):
        assert np.hypot(*(points - end).T).min() < 1e-12
    first = along(WALLS[:1], spacing)
    assert np.hypot(*np.diff(first, axis=0).T).max() <= spacing + 1e-9


def test_walls_that_nobody_saw_do_not_count():
    """One scan, half of the room: covered is the share of what was seen."""
    found, _ = by_name(LOG[:1])
    assert found["points"].covered == 1 and found["segments"].covered > 0.95


def test_large_cells_do_not_change_what_the_others_cover():
    """Catches a share of what any way covers: centres of large cells reach behind corners."""
    walls = np.concatenate([WALLS, [[(2.0, 3.5), (4.0, 3.5)]]])  # behind the room, nobody saw it
    fine, coarse = (by_name(LOG, walls, resolution=size)[0] for size in (0.05, 0.4))
    for name in ("segments", "reduced segments"):
        assert coarse[name].covered == fine[name].covered > 0.9
    assert coarse["quadtree"].covered < 0.5


def test_where_nothing_was_seen_there_is_no_share():
    kept = keep(LOG[:1], LOG.truth[:1]).kept
    assert np.isnan(judge(kept, WALLS + 100.0)[0].covered)


def test_an_empty_map_covers_nothing():
    kept = keep(LOG[:1], LOG.truth[:1], resolution=0.05).kept
    none = kept[0]._replace(points=np.empty((0, 2)), nbytes=0)
    assert judge([kept[0], none], WALLS)[1].covered == 0


def test_the_table_says_it_in_numbers():
    found, _ = by_name()
    rows = storage_table(found.values()).rows
    assert [row[0] for row in rows] == [
        "points",
        "segments",
        "reduced segments",
        "quadtree",
        "dense grid",
    ]
    assert rows[0][1] == str(found["points"].kept.parts)


def test_the_corridor_of_the_chapter():
    """What chapter 66 says: three kilobytes of segments, sixty times as much in the tree."""
    from segmap.simulation import corridor_loop

    log = load("corridor")
    found, _ = by_name(log, corridor_loop())
    assert found["reduced segments"].kept.nbytes < 5e3
    assert found["reduced segments"].error < 0.003
    assert found["quadtree"].kept.nbytes > 30 * found["reduced segments"].kept.nbytes
