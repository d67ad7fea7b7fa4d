"""The picture of a live map: every pixel is what the map says at its middle."""

import io

import numpy as np
import pytest
from matplotlib.image import imread

from segmap import LaserScan
from segmap.panels._live_picture import Greys, LivePicture
from segmap.plotting import ERROR, RAW, RESULT
from segmap.poses import compose
from segmap.quadtree import QuadtreeMap, extent

#: Pixels of the picture, of its axes at most, and how many cells there are at least to a pixel.
WIDE, HIGH, AXES, SHARE = 480, 360, (0.89 * 480, 0.86 * 360), 0.7


def mapped(*scans, resolution=0.05, **settings):
    map = QuadtreeMap(resolution=resolution, free_resolution=16 * resolution, **settings)
    for sensor, ends in scans:
        map.insert_scan(sensor, ends)
    return map


def plain(map, view, side):
    """The grid by the finest cells: the most occupied one of each square, else its middle."""
    many = round(side / map.resolution)
    x, y = (np.arange(view[k], view[k + 2] - 1e-9, map.resolution) for k in (0, 1))
    centres = np.stack(np.meshgrid(x, y), -1) + map.resolution / 2
    fine = map.occupancy(centres.reshape(-1, 2)).reshape(len(y), len(x))
    most = fine.reshape(len(y) // many, many, len(x) // many, many).max((1, 3))
    return np.where(most > 0.5, most, fine[many // 2 :: many, many // 2 :: many])


def assert_view(greys, map):
    """The least view that holds all hits with a margin, in the smallest cells worth a pixel."""
    needed, side = np.array(extent(map, margin=0.08)), greys.side
    pixel = max((needed[2:] - needed[:2]) / AXES)
    assert side == map.resolution or side / 2 < SHARE * pixel
    assert side >= SHARE * pixel and np.log2(side / map.resolution) % 1 == 0
    over = (needed - greys.view) * (1, 1, -1, -1) / (16 * side)
    assert (over >= -1e-9).all() and (over < 1).all()
    edges = np.array(greys.view) / (16 * side)
    assert edges == pytest.approx(np.round(edges))


def assert_shows(greys, map):
    assert_view(greys, map)
    assert np.array_equal(greys.grid, plain(map, greys.view, greys.side))


@pytest.mark.parametrize("wide", [True, False])
def test_the_view_of_a_map_of_any_size(wide):
    """Catches cells that are too coarse for a pixel or too fine, and a view that cuts a wall."""
    for size in np.geomspace(3, 60, 60):
        ends = np.array([(size, 0.01), (-1, size / 20), (-1.5, -size / 9)])
        map, greys = mapped(((0, 0), ends if wide else ends[:, ::-1])), Greys()
        assert greys.update(map, np.zeros((1, 2)))
        assert_view(greys, map)


@pytest.mark.parametrize("resolution", [0.02, 0.005])
def test_what_a_scan_cannot_change_is_not_asked_again(resolution):
    """Every cell drawn is that of the map: catches a box that is too small for its rays."""
    map, greys = QuadtreeMap(resolution=resolution, free_resolution=16 * resolution), Greys()
    views, rng = [], np.random.default_rng(1)
    for x, y in [(0, 0), (1, 0), (2, 1), (1, 2), (0, 0), (-2, -1), (-1, 0), (3, -1), (4, 0)]:
        ends = (x, y) + rng.uniform(-1.5, 1.5, (20, 2))
        map.insert_scan((x, y), ends)
        before = greys.view, greys.side
        views.append(greys.update(map, np.vstack([(x, y), ends])))
        assert views[-1] == ((greys.view, greys.side) != before)
        assert_shows(greys, map)
    assert 2 < sum(views) < 9


def test_another_map_is_asked_as_a_whole():
    """Catches a picture that shows, far from the robot, a map that another has replaced."""
    greys, ends = Greys(), np.array([(2.0, 2.0), (-2.0, 2.0), (-2.0, -2.0), (2.0, -2.0)])
    for count in (1, 30):
        map = mapped(*[((0.0, 0.0), ends)] * count)
        greys.update(map, np.array([(0.0, 0.0)]))
        assert_shows(greys, map)


# ------------------------------------------------------------------ pixels


def decoded(png):
    """Red, green and blue of each pixel, 0 to 255, the top row first."""
    assert png[24:29] == bytes([8, 2, 0, 0, 0]), "eight bits of three colours"
    return np.rint(255 * imread(io.BytesIO(png))).astype(int)


def at(picture, x, y):
    """Row and column of the pixel that holds a point."""
    column, up = picture.axes.transData.transform((x, y))
    return HIGH - 1 - int(up), int(column)


def color(name):
    return [int(name[k : k + 2], 16) for k in (1, 3, 5)]


SQUARE = np.array([(2.0, 1.5), (-2.0, 1.5), (-2.0, -1.5), (2.0, -1.5)])


@pytest.mark.parametrize("scale", [(1, 1), (0.2, 1), (1, 0.2), (9, 9)])
def test_each_pixel_is_the_cell_at_its_middle(scale):
    """Catches a picture that is upside down, half a pixel off, or cut to the wrong frame."""
    rng, picture = np.random.default_rng(2), LivePicture()
    ends = SQUARE * scale
    inner = [ends * rng.uniform(0.3, 1, (4, 2)) for _ in range(60)]
    map = mapped(((0, 0), ends), ((0.3, 0.2), np.concatenate(inner)))
    picture.show(map, LaserScan([np.inf], [0.0]), np.zeros(3), np.empty((0, 2, 2)))
    pixels = decoded(picture.png())
    assert pixels.shape == (HIGH, WIDE, 3) and picture.figure.dpi == 72
    left, low, right, high = picture.greys.view
    assert (picture.axes.get_xlim(), picture.axes.get_ylim()) == ((left, right), (low, high))
    frame = picture.axes.bbox.get_points().round().astype(int)
    column, up = (np.arange(*frame[:, k]) for k in (0, 1))
    middles = np.stack(np.meshgrid(column, up), -1).reshape(-1, 2) + 0.5
    x, y = picture.axes.transData.inverted().transform(middles).T
    side, grid = picture.greys.side, plain(map, picture.greys.view, picture.greys.side)
    rows = np.clip((y - low) / side, 0, len(grid) - 1).astype(int)
    grey = grid[rows, np.clip((x - left) / side, 0, grid.shape[1] - 1).astype(int)]
    wanted = (255 * (1 - grey) + 0.5).astype(int).reshape(len(up), len(column))
    found = pixels[::-1][frame[0, 1] : frame[1, 1], frame[0, 0] : frame[1, 0]]
    off = (found != wanted[..., None]).any(2)
    assert len(np.unique(wanted)) > 3
    y, x = HIGH - 1 - at(picture, 0, 0)[0] - frame[0, 1], at(picture, 0, 0)[1] - frame[0, 0]
    off[y - 5 : y + 6, x - 5 : x + 6] = False  # the robot
    assert off.mean() < 1e-4, "but for ties of a rounding"
    assert pixels[:, : frame[0, 0] - 5].min() < 100 > pixels[HIGH - frame[0, 1] + 5 :].min()
    held = picture.axes.get_tightbbox()
    assert -2 < held.x0 < held.x1 < WIDE and -2 < held.y0 < held.y1 < HIGH, "numbers and names"
    share = (frame[1] - frame[0]) / AXES
    assert max(share) == pytest.approx(1, abs=0.01)


def test_what_is_drawn_over_the_map_moves_and_leaves_no_trace():
    """Catches a robot at the pose of its body's middle, and a drawing that piles up."""
    assert decoded(LivePicture().png())[HIGH // 2, WIDE // 2].tolist() == [128] * 3
    map, picture = mapped(((0, 0), SQUARE)), LivePicture()
    walls = np.array([[(-1.0, 0.5), (1.0, 0.5)], [(-1.0, 1.0), (-1.0, 1.3)]])
    reduced = np.array([[(-1.5, -1.0), (1.5, -1.0)]])
    scan = LaserScan([1.0, 0.5], [0.0, np.pi / 2], sensor_pose=(0.2, 0.0, 0.0))
    for pose in (np.array([-1.0, 0.0, 0.0]), np.array([1.0, -0.5, np.pi / 2])):
        picture.show(map, scan, pose, walls, reduced)
        pixels = decoded(picture.png())
        sensor = compose(pose, (0.2, 0, 0))[:2]
        assert pixels[at(picture, *sensor)].tolist() == color(ERROR)
        for segment in (*walls, *reduced):
            row, column = at(picture, *segment.mean(0))
            near = pixels[row - 1 : row + 2, column - 1 : column + 2].reshape(-1, 3)
            assert abs(near - color(RESULT)).max(1).min() < 70
        beams = [[(1, 0), (0, 0.5)], [(0, 1), (-0.5, 0)]][int(pose[0] > 0)]
        assert np.array(picture.points.get_data()).T - sensor == pytest.approx(np.array(beams))
    assert np.ptp(pixels[at(picture, -0.8, 0.0)]) == 0, "where it was"
    assert np.array(picture.walls.get_data()).T.tolist()[:2] == walls[0].tolist()
    assert np.isnan(np.array(picture.walls.get_data())[:, [2, 5]]).all()
    picture.show(map, scan, pose, walls[:1])
    assert len(picture.reduced.get_xdata()) == 0
    looks = [(p.get_color(), p.get_marker(), p.get_linewidth()) for p in picture.parts[1:3]]
    assert looks == [(RESULT, "None", 2), (RESULT, "None", 1)]
    dots = [(p.get_color(), p.get_marker(), p.get_markersize()) for p in picture.parts[::3]]
    assert dots == [(RAW, ".", 2), (ERROR, "o", 6)]
    axes = picture.axes
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("x [m]", "y [m]")
    ticks = axes.xaxis.get_major_locator().tick_values(0, 6)
    assert ticks.tolist() == [0, 2, 4, 6], "five numbers at most"


# ------------------------------------------------------------------ the panel that shows it
