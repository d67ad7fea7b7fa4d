"""The way of a robot on a quadtree map, by exact distances and by a search on the finest grid."""

import numpy as np
import pytest
from conftest import slow
from scipy.ndimage import binary_dilation
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from segmap import simulation
from segmap.matching import NoRoute, route
from segmap.plotting import square_corners
from segmap.quadtree import QuadtreeMap, build_map
from segmap.segments import point_distance

DRIVE = [(1, 5), (11, 5), (10, 5), (10, 3), (10, 5), (2, 5), (2, 7), (2, 5), (6, 5), (6, 7)]


def office_map(seed, corner=(-3.2, -3.2), shift=(0, 0, 0)):
    """An office as a robot saw it that drove through the corridor and into three rooms."""
    rng = np.random.default_rng(seed)
    walls = simulation.office(rng=rng)
    path = simulation.drive(DRIVE, step=0.5, turn=0.5)
    log = simulation.simulate(walls, path, sensor=simulation.URG_04LX, rng=rng)
    poses = log.truth + shift
    return build_map(log, poses, resolution=0.05, free_resolution=0.1, corner=corner)


@pytest.fixture(scope="module")
def office():
    return office_map(1)


def distance_from_walls(map, way):
    """From a way to the nearest occupied cell, exact: a line through one is near its corners."""
    leaves, wall = map.leaves(), map.leaf_occupancy() > 0.5
    x, y, side = leaves.x[wall], leaves.y[wall], leaves.side[wall]
    corners = square_corners(x, y, side)
    sides = np.stack([corners, np.roll(corners, 1, 1)], 2).reshape(-1, 2, 2)
    pieces = np.stack([way[:-1], way[1:]], 1)
    from_corners = point_distance(sides[:, 0], pieces[:, None])
    return min(from_corners.min(), point_distance(way[:, None], sides).min())


def length(way):
    return float(np.hypot(*np.diff(way, axis=0).T).sum())


def clear_on_grid(map, radius):
    """Free cells that keep a radius from all occupied ones, (rows, columns)."""
    grid, cells = map.to_grid(), int(np.ceil(radius / map.resolution)) + 1
    i, j = np.mgrid[-cells : cells + 1, -cells : cells + 1]
    gap = np.hypot(*np.maximum(np.abs([i, j]) - 1, 0)) * map.resolution
    return (grid < 0.5) & ~binary_dilation(grid > 0.5, gap < radius - 1e-9)


def length_on_grid(map, start, goal, radius):
    """The shortest way over cells, from middle to middle, to all eight neighbours."""
    clear = clear_on_grid(map, radius)
    index = np.arange(clear.size, dtype=np.int32)  # as the oldest scipy wants it
    number = np.where(clear, index.reshape(clear.shape), np.int32(-1))
    links = []
    for step in ((0, 1), (1, 0), (1, 1), (1, -1)):
        beside = np.roll(number, -np.array(step), (0, 1))
        both = (number >= 0) & (beside >= 0)
        for corner in ((step[0], 0), (0, step[1])):  # no cutting of corners
            both &= np.roll(clear, -np.array(corner), (0, 1))
        links.append((number[both], beside[both], np.full(both.sum(), np.hypot(*step))))
    one, other, far = (np.concatenate(part) for part in zip(*links, strict=True))
    graph = coo_array((far, (one, other)), shape=(clear.size,) * 2).tocsr()
    ends = [
        np.floor((np.array(p) - map.bounds[:2]) / map.resolution).astype(int) for p in (start, goal)
    ]
    a, b = (number[y, x] for x, y in ends)
    assert a >= 0 and b >= 0
    return dijkstra(graph, directed=False, indices=a)[b] * map.resolution


@pytest.mark.parametrize("seed", [*range(2), *map(slow, range(2, 12))])
def test_it_keeps_its_distance_and_is_short(seed):
    """Catches a corner cut through a wall or through the unknown, leaves that are dropped whole
    beside a wall, and a way along the sides of cells. The way is never longer than the one over
    cells, to eight neighbours, but for the half cells at its ends; nor shorter than that allows,
    by the angle of 22.5 degrees between its directions."""
    map, rng = office_map(seed), np.random.default_rng(seed)
    found = 0
    for _ in range(40):
        start, goal = rng.uniform((0.5, 1), (11.5, 9), (2, 2))
        radius = float(rng.uniform(0.05, 0.4))
        try:
            way = route(map, start, goal, radius=radius)
        except NoRoute:
            continue
        found += 1
        assert distance_from_walls(map, way) >= radius - 1e-6
        part = np.linspace(0, 1, 997)[:, None, None]
        assert (map.occupancy((way[:-1] + part * np.diff(way, axis=0)).reshape(-1, 2)) < 0.5).all()
        assert way[[0, -1]] == pytest.approx(np.array([start, goal]))
        over_cells, ends = length_on_grid(map, start, goal, radius), 2 * map.resolution
        assert over_cells * np.cos(np.pi / 8) - ends < length(way) < over_cells + ends
    assert found > 5


def test_a_larger_robot_takes_the_longer_way(office):
    """Between corridor and room; backwards it is as long. Larger than the door there is none."""
    found = [length(route(office, (1, 5), (10, 3), radius=r)) for r in (0.05, 0.2, 0.35)]
    assert found == sorted(found) and found[0] < found[-1] - 0.02
    back = length(route(office, (10, 3), (1, 5), radius=0.2))
    assert back == pytest.approx(found[1], rel=0.01)
    with pytest.raises(NoRoute, match=r"no way .* keeps 0.5 m from walls: it is too narrow"):
        route(office, (1, 5), (10, 2.7), radius=0.5)


def test_of_several_goals_the_nearest_to_drive_to(office):
    """The second is nearer as the crow flies, behind a wall; the third cannot be stood on."""
    goals, start = [(6, 5), (2, 7), (0, 0)], (3.6, 5)
    ways = [route(office, start, goal, radius=0.2) for goal in goals[:2]]
    nearest = min(ways, key=length)
    assert np.array_equal(route(office, start, goals, radius=0.2), nearest)
    assert np.array_equal(route(office, start, goals[::-1], radius=0.2), nearest)


def test_it_moves_with_the_map():
    """Equal up to ways of one length; where the tree's squares lie otherwise it is as long, too."""
    shift, ends = np.array([6.4, -12.8]), np.array([(1, 5), (10, 3)])
    one = route(office_map(2), *ends, radius=0.2)
    moved = office_map(2, corner=shift - 3.2, shift=(*shift, 0))
    other = route(moved, *(ends + shift), radius=0.2)
    assert length(other) == pytest.approx(length(one), rel=0.005)
    assert np.abs(other - shift - one).max() < 0.4
    uneven = office_map(2, corner=(-3.15, -3.35))
    assert length(route(uneven, *ends, radius=0.2)) == pytest.approx(length(one), rel=0.02)


@pytest.mark.parametrize(
    ("start", "goal", "said"),
    [
        ((1.0, 3.98), (6, 5), r"start \(1, 3.98\) lies in a wall"),
        ((1, 5), (50, 5), r"goal \(50, 5\) lies where nothing has been seen"),
        ((1, 5), (4.0, 1.0), "goal .* lies where nothing has been seen"),
        ((1.0, 4.15), (6, 5), "start .* lies nearer than 0.2 m to a wall"),
        ((1, 5), [(50, 5), (50, 6)], r"goal \(50, 5\) lies where"),
    ],
)
def test_why_there_is_none(office, start, goal, said):
    with pytest.raises(NoRoute, match=said):
        route(office, start, goal, radius=0.2)


def test_unknown_space_between_is_said():
    """Two scans that saw nothing of each other."""
    map = QuadtreeMap(resolution=0.1, free_resolution=0.1)
    for x in (0.05, 10.05):
        map.insert_scan((x, 0.05), [], free_points=[(x, 2.05)])
    with pytest.raises(NoRoute, match="walls or unknown space close it"):
        route(map, (0.05, 0.05), (10.05, 0.05), radius=0.2)


def test_without_walls_and_without_a_way_to_drive():
    map = QuadtreeMap(resolution=0.1, free_resolution=0.1)
    map.insert_scan((0.05, 0.05), [], free_points=[(2.05, 0.05)])
    assert route(map, (0.05, 0.05), (2.0, 0.05), radius=0.2).tolist() == [[0.05, 0.05], [2.0, 0.05]]
    assert length(route(map, (0.05, 0.05), (0.05, 0.05), radius=0.2)) == 0
    with pytest.raises(ValueError, match="at least one place"):
        route(map, (0.05, 0.05), np.zeros((0, 2)), radius=0.2)
    with pytest.raises(NoRoute, match="nothing has been seen"):
        route(QuadtreeMap(), (0.05, 0.05), (0.05, 0.05), radius=0.2)


@pytest.mark.parametrize("seed", range(2))
def test_a_straight_line_sees_each_cell_that_it_crosses(seed):
    """Among scattered posts of one cell, whichever way it runs and to places inside of cells.

    Catches the last or the first cell of a line that nobody looks at.
    """
    rng, map = np.random.default_rng(seed), QuadtreeMap(resolution=1, size=16, free_resolution=1)
    for _ in range(60):
        map.insert_scan((8.5, 8.5), [], free_points=rng.uniform(0, 16, (40, 2)))
    posts = np.unique(rng.integers(1, 15, (24, 2)), axis=0) + 0.5
    for post in posts:
        map.insert_scan(post, [post] * 999)
    assert (map.occupancy(posts) > 0.5).mean() > 0.9
    ends = rng.uniform(0.5, 15.5, (30, 2, 2))
    found = 0
    for start, goal in ends[(map.occupancy(ends.reshape(-1, 2)).reshape(-1, 2) < 0.5).all(1)]:
        try:
            way = route(map, start, goal, radius=1e-9)
        except NoRoute:
            continue
        part = np.linspace(0, 1, 601)[:, None, None]
        along = (way[:-1] + part * np.diff(way, axis=0)).reshape(-1, 2)
        assert (map.occupancy(along) < 0.5).all(), (start, goal)
        found += 1
    assert found > 4
