"""Maps for ROS, read back by a reader that knows the format and not the library."""

import json
import re

import numpy as np
import pytest
from quadtrees import corner_map, room

from segmap.exports import ros_classes
from segmap.quadtree import QuadtreeMap
from segmap_app.files import write_ros_map

assert room  # the fixture


# ------------------------------------------------------------------------------- ROS
def read_ros(path):
    """By the rules of map_server: values -1 unknown, 0 free, 100 occupied, row 0 lowest."""
    fields = dict(re.findall(r"^(\w+): *(.*)$", path.read_text(), re.MULTILINE))
    kind, size, most, pixels = (
        (path.parent / json.loads(fields["image"])).read_bytes().split(b"\n", 3)
    )
    columns, rows = map(int, size.split())
    assert (kind, most, fields["negate"], fields["mode"]) == (b"P5", b"255", "0", "trinary")
    grey = np.frombuffer(pixels, np.uint8).reshape(rows, columns).astype(float)
    share = (255 - grey) / 255
    values = np.full(share.shape, -1)
    values[share > float(fields["occupied_thresh"])] = 100
    values[share < float(fields["free_thresh"])] = 0
    return values[::-1], json.loads(fields["origin"]), float(fields["resolution"])


def classes(map, values, origin, side, occupied=0.5, free=0.25):
    """What the map itself says at the centres of the cells."""
    rows, columns = values.shape
    x, y = origin[0] + (np.arange(columns) + 0.5) * side, origin[1] + (np.arange(rows) + 0.5) * side
    centres = np.stack(np.meshgrid(x, y), -1).reshape(-1, 2)
    value = map.occupancy(centres).reshape(rows, columns)
    return np.select([value > occupied, value <= free], [100, 0], -1)


@pytest.mark.parametrize("options", [{}, {"occupied": 0.8}, {"free": 0.0}])
def test_another_reader_finds_the_map(room, options, tmp_path):
    """Catches rows upside down, an origin at the centre of a pixel, exchanged axes and greys."""
    write_ros_map(tmp_path / "room.yaml", room, **options)
    values, origin, side = read_ros(tmp_path / "room.yaml")
    assert origin[2] == 0 and side == 0.05
    assert np.array_equal(values == 0, ros_classes(room, **options).greys == 254)
    assert np.array_equal(values == 100, ros_classes(room, **options).greys == 0)
    assert np.array_equal(values, classes(room, values, origin, side, **options))
    assert {-1, 0, 100} == set(np.unique(values))
    assert not np.array_equal(values, values[::-1])
    grid = room.to_grid()  # no known cell is cut off, and no border of unknown ones is left
    assert (values == 100).sum() == (grid > options.get("occupied", 0.5)).sum()
    assert (values == 0).sum() == (grid <= options.get("free", 0.25)).sum()
    edges = values[0], values[-1], values[:, 0], values[:, -1]
    assert all((edge >= 0).any() for edge in edges)


def test_the_lower_left_corner_is_the_origin(tmp_path):
    """By hand: the cell of the sensor is the first of the lowest row."""
    write_ros_map(tmp_path / "it.yaml", corner_map(), occupied=0.6, free=0.1)
    values, origin, _ = read_ros(tmp_path / "it.yaml")
    assert origin[:2] == pytest.approx([-3.07, 1.13])
    assert values[0, 0] == 0 and values[-1, -1] == 100
    assert values.shape == (8, 8)
    text = (tmp_path / "it.yaml").read_text()
    assert "free: occupancy <= 0.1, occupied: occupancy > 0.6, else unknown; bias 1" in text


@pytest.mark.parametrize("times", [2, 4])
def test_coarse_pixels_lose_no_obstacle(room, times, tmp_path):
    """Catches a pixel that is free though one of its cells is not."""
    write_ros_map(tmp_path / "it.yaml", room, resolution=0.05 * times)
    values, (x, y, _), side = read_ros(tmp_path / "it.yaml")
    assert side == pytest.approx(0.05 * times)
    columns, rows = np.rint((np.array([x, y]) - room.bounds[:2]) / side).astype(int)
    cells = room.to_grid().reshape(-1, times, len(room.to_grid()) // times, times)
    highest = cells.max((1, 3))[rows:, columns:][: values.shape[0], : values.shape[1]]
    expected = np.select([highest > 0.5, highest <= 0.25], [100, 0], -1)
    np.testing.assert_array_equal(values, expected)
    assert (values == 0).mean() > 0.2


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
    assert (read_ros(tmp_path / f"{name}.yaml")[0] == np.full((4, 4), -1)).all()


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
