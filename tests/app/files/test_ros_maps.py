"""Maps for ROS read back by the rules of map_server: ours to the cell, nonsense by its name."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from segmap import load
from segmap.exports import ros_classes
from segmap.quadtree import QuadtreeMap, build_map, map_of_grid
from segmap.readers import LogError
from segmap_app.files import is_ros_map, read_ros_map, write_ros_map

YAML = """\
image: it.png
resolution: 0.5
origin: [-1.0, 2.0, 0.0]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.196
"""


def written(picture, text=YAML, *swaps):
    """A YAML beside a picture whose last row is the lowest."""
    from pathlib import Path

    picture = picture if isinstance(picture, Image.Image) else Image.fromarray(picture)
    picture.save("it.png")
    for old, new in swaps:
        assert old in text
        text = text.replace(old, new)
    Path("it.yaml").write_text(text)
    return "it.yaml"


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def states(map, *places):
    return map.occupancy(np.array(places)).tolist()


ROW = np.array([[254, 205, 0]], np.uint8)
#: The middles of the three cells of `ROW`.
THREE = (-0.75, 2.25), (-0.25, 2.25), (0.25, 2.25)


def test_our_own_map_comes_back_to_the_cell(tmp_path):
    """Catches rows upside down, a corner at the centre of a pixel, a state that is another."""
    log = load("room")
    map = build_map(log, log.truth, resolution=0.05)
    write_ros_map("it.yaml", map)
    found = read_ros_map("it.yaml")
    before, after = ros_classes(map), ros_classes(found)
    assert np.array_equal(before.greys, after.greys)
    assert after[1:] == pytest.approx(before[1:]) and {*np.unique(after.greys)} == {0, 205, 254}
    found.save("it.npz")  # what the loops rely on is checked there
    assert np.array_equal(QuadtreeMap.load("it.npz").leaf_occupancy(), found.leaf_occupancy())


@pytest.mark.parametrize(
    ("picture", "swaps", "expected"),
    [
        (ROW, (), [0, 0.5, 1]),
        (ROW, (("negate: 0", "negate: 1"),), [1, 1, 0]),  # 205 is 0.80 dark then
        (ROW, (("0.65", "0.19"), ("0.196", "0.1")), [0, 1, 1]),
        (ROW, (("0.196", "0.2"),), [0, 0, 1]),
        (Image.fromarray(ROW).convert("RGB"), (), [0, 0.5, 1]),
        (Image.fromarray(ROW).convert("P"), (), [0, 0.5, 1]),
        (ROW.astype(np.uint16) * 257, (), [0, 0.5, 1]),
        (Image.fromarray(ROW[:, ::2] > 9), (), [0, 1, 0.5]),
    ],
)  # fmt: skip
def test_a_pixel_means_what_map_server_says(picture, swaps, expected):
    """Catches thresholds of another darkness, a negative, colours and depths taken wrongly."""
    assert states(read_ros_map(written(picture, YAML, *swaps)), *THREE) == expected


def test_shades_and_clear_pixels_of_a_scale_map_are_unknown_and_told():
    """Catches a wall half as dark that is taken for one, and a loss that nobody hears of."""
    picture = np.array([[(0, 0, 0, 255), (120, 120, 120, 255), (0, 0, 0, 0)]], np.uint8)
    name = written(picture, YAML, ("negate: 0", "negate: 0\nmode: scale"))
    with pytest.warns(UserWarning, match="1 cells have a shade between the thresholds"):
        assert states(read_ros_map(name), *THREE) == [1, 0.5, 0.5]


def test_lists_quotes_comments_and_paths_are_those_of_yaml(tmp_path):
    """Catches a YAML as another program writes it that is called nonsense."""
    text = (
        "%YAML 1.1\n---\nimage: 'it.png'   # the picture\nresolution: 5e-1\norigin:\n- -1.0\n"
        "- 2.0\n- 0\nnegate: false\noccupied_thresh: 0.65\nfree_thresh: 0.196\nmode: trinary\n"
    )
    assert states(read_ros_map(written(ROW, text)), *THREE) == [0, 0.5, 1]
    (tmp_path / "below").mkdir()
    far = written(ROW, text, ("'it.png'", f'"{tmp_path}/it.png"'))
    assert states(read_ros_map(far), *THREE) == [0, 0.5, 1]
    other = written(ROW, text, ("'it.png'", "C:\\maps\\it.png"), ("negate: false\n", ""))
    with pytest.warns(UserWarning, match=r"is not there: it\.png is"):
        assert states(read_ros_map(other), *THREE) == [0, 0.5, 1]
    for encoding in ("utf-8-sig", "utf-16"):
        Path("it.yaml").write_bytes(text.removeprefix("%YAML 1.1\n---\n").encode(encoding))
        assert is_ros_map("it.yaml") and states(read_ros_map("it.yaml"), *THREE) == [0, 0.5, 1]
    assert is_ros_map("it.yaml") and not is_ros_map("it.png") and not is_ros_map("gone.yaml")


@pytest.mark.parametrize(
    ("swap", "said"),
    [
        (("resolution: 0.5", "resolution: nan"), "resolution must be a number from"),
        (("resolution: 0.5\n", ""), "has no resolution"),
        (("[-1.0, 2.0, 0.0]", "[-1.0, 2.0]"), "origin must be [x, y, yaw]"),
        (("2.0, 0.0]", "2.0, 0.5]"), "its yaw must be 0"),
        (("0.65", "65"), "occupied_thresh must be"),
        (("0.196", "0.9"), "free_thresh must not be above"),
        (("negate: 0", "negate: 0\nmode: raw"), "mode must be one of"),
        (("[-1.0, 2.0, 0.0]", "[-1.0, nan, 0.0]"), "each of origin must be a number"),
        (("negate: 0", "negate: [0"), "is no YAML"),
        (("it.png", "gone.png"), "image is not there"),
        (("it.png", "it.yaml"), "is no picture that can be read"),
    ],
)
def test_nonsense_is_told(swap, said):
    """Catches a map of cells without a side, and a traceback of Pillow."""
    with pytest.raises(LogError) as told:
        read_ros_map(written(ROW, YAML, swap))
    assert said in str(told.value)


@pytest.mark.parametrize("shape", [(1, 1), (3, 5), (8, 8), (1, 70), (65, 2)])
def test_a_grid_of_any_shape_is_itself_in_a_tree(shape):
    """Catches a row or column that is lost where the sides are no powers of two."""
    cells = np.random.default_rng(1).integers(0, 3, shape)
    map = map_of_grid(cells, resolution=0.25, corner=(-3.0, 7.0))
    rows, columns = np.indices(shape)
    x, y = -3.0 + 0.25 * (columns + 0.5), 7.0 + 0.25 * (rows + 0.5)
    found = map.occupancy(np.stack([x.ravel(), y.ravel()], -1)).reshape(shape)
    assert np.array_equal(found, np.array([0.5, 0, 1])[cells])
    map.insert_scan((0.0, 7.1), [(40.0, 7.1)])  # and it grows like any other
    assert map.occupancy([(40.0, 7.1)]) == 1
