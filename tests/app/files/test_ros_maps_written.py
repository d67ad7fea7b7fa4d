"""Maps for ROS as they are written: each cell in its place, and both files or none."""

import json
import re

import numpy as np
import pytest
from quadtrees import corner_map, room

from segmap.exports import ros_classes
from segmap.quadtree import QuadtreeMap
from segmap_app.files import read_ros_map, write_ros_map

assert room  # the fixture


def centres_of(map, side):
    """The middles of cells of this side on all of a map, row by row, `(rows, columns, 2)`."""
    left, low, right, high = map.bounds
    x, y = (np.arange(a + side / 2, b, side) for a, b in ((left, right), (low, high)))
    return np.stack(np.meshgrid(x, y), -1)


@pytest.mark.parametrize("times", [1, 2, 4])
@pytest.mark.parametrize(("occupied", "free"), [(0.5, 0.25), (0.8, 0.25), (0.5, 0.0)])
def test_each_cell_is_what_the_map_says_there(room, times, occupied, free, tmp_path):
    """Catches rows upside down, an origin at the centre of a pixel, exchanged axes and greys, and a
    coarse pixel that is free though one of its cells is not."""
    rules = {"resolution": 0.05 * times, "occupied": occupied, "free": free}
    write_ros_map(tmp_path / "room.yaml", room, **rules)
    written = read_ros_map(tmp_path / "room.yaml")
    centres = centres_of(room, 0.05)
    cells = room.occupancy(centres.reshape(-1, 2)).reshape(centres.shape[:2])
    rows, columns = (n // times for n in cells.shape)
    highest = cells.reshape(rows, times, columns, times).max((1, 3))
    expected = np.select([highest > occupied, highest <= free], [1.0, 0.0], 0.5)
    seen = written.occupancy(centres_of(room, 0.05 * times).reshape(-1, 2))
    np.testing.assert_array_equal(seen.reshape(rows, columns), expected)
    assert {*np.unique(expected)} == {0, 0.5, 1} and written.resolution == 0.05 * times
    greys = ros_classes(room, **rules).greys  # no border of unknown cells is left
    assert all((edge != 205).any() for edge in (greys[0], greys[-1], greys[:, 0], greys[:, -1]))


def test_the_lower_left_corner_is_the_origin(tmp_path):
    """By hand: the cell of the sensor is the first of the lowest row."""
    write_ros_map(tmp_path / "it.yaml", corner_map(), occupied=0.6, free=0.1)
    text = (tmp_path / "it.yaml").read_text()
    assert json.loads(re.search(r"origin: (.*)", text)[1])[:2] == pytest.approx([-3.07, 1.13])
    assert "free: occupancy <= 0.1, occupied: occupancy > 0.6, else unknown; bias 1" in text
    places = [(-3.07 + 0.25 * (k + 0.5), 1.13 + 0.25 * (k + 0.5)) for k in (0, 7)]
    assert read_ros_map(tmp_path / "it.yaml").occupancy(places).tolist() == [0, 1]
    assert (tmp_path / "it.pgm").read_bytes().startswith(b"P5\n8 8\n255\n")


@pytest.mark.parametrize(
    ("name", "corner"),
    [
        ("it", (1e-17, -1e-5)),
        ("a: #1 'Málaga'", (-1e7, 1e-300)),
        ("\N{HOUSE BUILDING}", (0.3, -0.1 * 3)),
    ],
)
def test_it_is_yaml_for_a_yaml_reader(name, corner, tmp_path):
    """Catches names that mean something else in YAML, and -1e-05, which is a word there."""
    yaml = pytest.importorskip("yaml", reason="PyYAML is not installed here")
    map = QuadtreeMap(resolution=1e-5, size=4e-5, corner=corner)
    write_ros_map(tmp_path / f"{name}.yaml", map)
    found = yaml.safe_load((tmp_path / f"{name}.yaml").read_text(encoding="utf-8"))
    assert (found["image"], found["resolution"]) == (f"{name}.pgm", 1e-5)
    assert found["origin"] == [*map.corner, 0.0]
    assert [type(v) for v in found["origin"]] == [float] * 3
    assert (found["occupied_thresh"], found["free_thresh"]) == (0.65, 0.196)


def test_no_description_of_a_picture_that_is_not_there(tmp_path):
    """Catches a YAML that is written first: a robot would load it with yesterday's picture."""
    (tmp_path / "it.pgm").mkdir()
    with pytest.raises(ValueError, match=r"it\.pgm is a folder"):
        write_ros_map(tmp_path / "it.yaml", corner_map())
    assert [path.name for path in tmp_path.iterdir()] == ["it.pgm"]


@pytest.mark.parametrize("failing", [".pgm", ".yaml"])
def test_a_description_never_lies_beside_the_picture_of_another_map(failing, tmp_path, monkeypatch):
    """The disk takes one of the two files and not the other.

    Catches a YAML that is moved to its place before its picture is.
    """
    write_ros_map(tmp_path / "it.yaml", corner_map(), occupied=0.9)
    before = [(tmp_path / f"it{end}").read_bytes() for end in (".pgm", ".yaml")]
    move = type(tmp_path).replace

    def moved(path, target):
        if str(target).endswith(failing):
            raise OSError(28, "No space left on device", str(path))
        return move(path, target)

    monkeypatch.setattr(type(tmp_path), "replace", moved)
    larger = QuadtreeMap(resolution=0.25, size=4)
    larger.insert_scan((0.1, 0.1), [(3.1, 2.1)])
    with pytest.raises(OSError, match="No space left"):
        write_ros_map(tmp_path / "it.yaml", larger)
    picture, text = ((tmp_path / f"it{end}").read_bytes() for end in (".pgm", ".yaml"))
    assert text == before[1] and (picture == before[0]) == (failing == ".pgm")
    assert len(list(tmp_path.iterdir())) == 2
