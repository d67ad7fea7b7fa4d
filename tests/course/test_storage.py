"""One building represented in five ways: bytes counted by hand, errors against known walls."""

import numpy as np
from segmap_course import compare_with_walls, represent, wall_errors

from segmap.simulation import URG_04LX, drive, rectangular_room, simulate

WALLS = rectangular_room(4.02, 3.02)
LOG = simulate(
    WALLS, drive([(1, 1), (3, 2)], step=0.2), sensor=URG_04LX, rng=np.random.default_rng(6)
)


def compared(log=LOG, walls=WALLS, **options):
    return compare_with_walls(represent(log, log.truth, **options), walls)


def test_bytes_are_those_of_the_arrays():
    """16 a point, 32 a segment, 8 a node, 8 a cell of the grid that just holds the walls."""
    found = represent(LOG, LOG.truth)
    assert found["points"].nbytes == 16 * sum(len(scan.points()) for scan in LOG)
    for name in ("segments", "reduced segments"):
        assert found[name].nbytes == 32 * found[name].parts == found[name].map.nbytes
    assert found["quadtree"].nbytes == found["quadtree"].map.nbytes
    cells = np.rint(found["dense grid"].points / 0.05).astype(int)
    rows, columns = np.ptp(cells, axis=0) + 1
    assert found["dense grid"].nbytes == 8 * rows * columns
    assert 4 / 0.05 <= max(rows, columns) <= 4.3 / 0.05


def test_scans_without_a_pose_are_left_out():
    """Catches points that are nowhere and yet counted: 126 of the 225 scans of Malaga."""
    poses = LOG.truth.copy()
    poses[1::2] = np.nan
    found, expected = represent(LOG, poses), represent(LOG[::2], LOG.truth[::2])
    for some, same in zip(found.values(), expected.values(), strict=True):
        assert (some.parts, some.nbytes) == (same.parts, same.nbytes)
        assert np.array_equal(some.points, same.points)
    assert represent(LOG[:0], np.empty((0, 3)))["points"].parts == 0


def test_errors_are_distances_from_the_nearest_wall():
    """Catches the distance from the line of a wall, and from its ends."""
    walls = [[(0, 0), (4, 0)], [(0, 0), (0, 3)]]
    points = np.array([(2, 0.5), (0.25, 2), (5, 0), (-3, -4)])
    np.testing.assert_allclose(wall_errors(points, walls), [0.5, 0.25, 1, 5])


def test_only_walls_that_the_points_reach_count():
    """Catches a share of what any way covers: centres of large cells reach behind corners."""
    walls = np.concatenate([WALLS, [[(2.0, 3.5), (4.0, 3.5)]]])  # behind the room, nobody saw it
    fine, coarse = (compared(LOG, walls, resolution=size)["covered"] for size in (0.05, 0.4))
    for name in ("segments", "reduced segments"):
        assert coarse[name] == fine[name] > 0.9
    assert coarse["quadtree"] < 0.5
    half = compared(LOG[:1])["covered"]  # one scan saw half of the room
    assert half["points"] == 1 and half["segments"] > 0.95
