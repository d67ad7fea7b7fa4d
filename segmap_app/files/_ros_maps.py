"""Maps of ROS' map_server, read and written: a YAML and the picture that it names.

    image: it.pgm             beside the YAML, or a whole path
    resolution: 0.05          side of a pixel, metres
    origin: [-3.0, 1.0, 0.0]  lower left corner of the lower left pixel, metres, and yaw, 0
    negate: 0                 1: white is occupied
    occupied_thresh: 0.65
    free_thresh: 0.196
    mode: trinary             or scale

The darkness of a pixel, 0 white to 1 black, is its occupancy: above `occupied_thresh` it is
occupied, below `free_thresh` free. https://wiki.ros.org/map_server
"""

from __future__ import annotations

import json
import math
import re
import warnings
from importlib import import_module
from pathlib import Path, PureWindowsPath
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from segmap import arrays
from segmap.arrays import LIMIT, Array, Quantity, checked, file
from segmap.display import pip_install
from segmap.exports import ros_classes
from segmap.files import escape, rewrite
from segmap.quadtree import FREE, OCCUPIED, UNKNOWN, QuadtreeMap, map_of_grid
from segmap.readers import LogError, read_text

#: Pixels of a map of 400 m by 400 m at 0.05 m.
MOST_MAP_PIXELS = 1 << 26
YAML_MODES = ("trinary", "scale")
#: What pictures map_server writes and people draw, by the names of Pillow.
KINDS = ("PPM", "PNG", "BMP")
#: A threshold that is checked together with another.
Number = Annotated[float, Quantity("")]
Cells = NDArray[np.int8]
#: Least share of black, `(255 - grey) / 255`, of an occupied cell; our YAML states it.
OCCUPIED_THRESH = 0.65
#: Largest share of black of a free cell; grey 205, unknown, lies between free and occupied.
FREE_THRESH = 0.196


def is_ros_map(path: str | Path) -> bool:
    """Whether a file is the YAML of a map for ROS, by its name and by a line that names an image.

    Examples
    --------
    >>> is_ros_map("room.npz")
    False
    """
    place = file(path)
    if place.suffix.lower() not in (".yaml", ".yml") or not place.is_file():
        return False
    try:
        return re.search(r"^image\s*:", read_text(place), re.MULTILINE) is not None
    except LogError:
        return False


def read_ros_map(path: str | Path) -> QuadtreeMap:
    """Read a map of map_server: a YAML and its picture, PGM, PNG or BMP.

    Of each cell it keeps whether it is free, occupied or unknown. How often a cell was seen is not
    in such a file: a map that `write_ros_map` wrote comes back with these three states alone. A
    `scale` map has shades between the thresholds, and transparent pixels: both become unknown; mode
    `raw`, whose pixels are no shades, and a yaw are refused.

    Raises
    ------
    LogError
        A YAML that says nonsense or leaves something out; a picture that is absent,
        damaged, or larger than 2^26 pixels.

    Warns
    -----
    UserWarning
        Saying what is lost: shades that become unknown.

    Examples
    --------
    >>> import tempfile
    >>> from segmap_app.files import write_ros_map
    >>> tree = QuadtreeMap(resolution=0.5, size=4, bias=1)
    >>> tree.insert_scan((0.2, 0.2), [(1.2, 0.2)])
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_ros_map(Path(folder) / "it.yaml", tree)
    ...     map = read_ros_map(Path(folder) / "it.yaml")
    >>> map.occupancy([(0.2, 0.2), (1.2, 0.2), (3.2, 3.2)])
    array([0. , 1. , 0.5])
    """
    place = file(path)
    yaml = _read_yaml(place)
    side = _number(place, yaml, "resolution", least=1e-9, most=LIMIT)
    x, y, yaw = (_number(place, yaml["origin"], k) for k in range(3))
    if yaw:
        raise LogError(place, f"its yaw must be 0, as map_server writes it, got {yaw:g}")
    occupied, free = (_number(place, yaml, f"{kind}_thresh", 0, 1) for kind in ("occupied", "free"))
    if free > occupied:
        raise LogError(place, f"free_thresh must not be above occupied_thresh, {occupied:g}")
    mode = str(yaml.get("mode", "trinary")).lower()
    if mode not in YAML_MODES:
        raise LogError(place, f"mode must be one of {', '.join(YAML_MODES)}, got {mode[:40]!r}")
    negate = str(yaml.get("negate", "0")).lower() in ("1", "true")
    grey, opaque = _picture(place, str(yaml["image"]))
    occupancy = (grey if negate else 255 - grey) / 255
    cells = np.select([occupancy > occupied, occupancy < free], [OCCUPIED, FREE], UNKNOWN)
    if mode == "scale":
        cells[~opaque] = UNKNOWN
        if lost := int(((cells == UNKNOWN) & opaque).sum()):
            words = f"{lost} cells have a shade between the thresholds, and become unknown"
            warnings.warn(f"{escape(place)}: {words}", UserWarning, stacklevel=2)
    cells = np.flipud(cells.astype(np.int8))
    try:
        return map_of_grid(cells, resolution=side, corner=(x, y))
    except ValueError as error:
        raise LogError(place, str(error)) from error


# ------------------------------------------------------------------------------ the picture
def _picture(path: Path, named: str) -> tuple[Array, NDArray[np.bool_]]:
    """Mean of the colours of each pixel, 0 to 255, row 0 at the top; and whether it is opaque."""
    from PIL import Image  # matplotlib brings it

    place = path.parent / named
    if not place.is_file():  # a whole path may be of the machine that made the map
        beside = path.parent / PureWindowsPath(named).name
        if not beside.is_file():
            words = f"image is not there, neither {escape(place)} nor beside the YAML"
            raise LogError(path, words)
        warnings.warn(f"{escape(place)} is not there: {beside.name} is", UserWarning, stacklevel=3)
        place = beside
    try:
        with Image.open(place, formats=KINDS) as image:
            columns, rows = image.size
            if columns * rows > MOST_MAP_PIXELS:
                raise ValueError(f"it has {columns} by {rows} pixels, at most 2^26 are read")
            if image.mode.startswith("I"):  # 16 bits
                return np.asarray(image, float) / 257, np.ones((rows, columns), bool)
            clear = "A" in image.getbands() or "transparency" in image.info
            kind = "RGBA" if clear else "L" if image.mode in ("1", "L") else "RGB"
            layers = np.asarray(image.convert(kind)).reshape(rows, columns, -1)
    except Exception as error:  # Pillow raises a dozen for damage
        raise LogError(place, f"is no picture that can be read ({escape(error)})") from error
    opaque = layers[..., 3] == 255 if clear else np.ones((rows, columns), bool)
    return layers[..., :3].mean(-1, dtype=np.float32), opaque


# --------------------------------------------------------------------------------- the YAML
def _read_yaml(path: Path) -> dict[str, Any]:
    """What the YAML of a map says, all of it as texts."""
    try:
        yaml: Any = import_module("yaml")
    except ImportError as error:
        raise ImportError(f"a map for ROS needs pyyaml: {pip_install('ros')}") from error
    try:
        fields = yaml.load(read_text(path), yaml.BaseLoader)
    except yaml.YAMLError as fault:
        raise LogError(path, f"is no YAML ({escape(fault)})") from fault
    for key in ("image", "resolution", "origin", "occupied_thresh", "free_thresh"):
        if not isinstance(fields, dict) or key not in fields:
            raise LogError(path, f"has no {key}, which the YAML of a map for ROS must say")
    if not isinstance(fields["origin"], list) or len(fields["origin"]) != 3:
        raise LogError(path, f"origin must be [x, y, yaw], got {str(fields['origin'])[:40]}")
    return dict(fields)


def _number(
    path: Path, said: Any, key: str | int, least: float = -LIMIT, most: float = LIMIT
) -> float:
    """A number between two bounds, by its key or by its place in the origin."""
    try:
        value = float(said[key])
    except (TypeError, ValueError):
        value = math.nan
    if not least <= value <= most:
        name = key if isinstance(key, str) else "each of origin"
        got = f"got {str(said[key])[:40]!r}"
        raise LogError(path, f"{name} must be a number from {least:g} to {most:g}, {got}")
    return value


@checked
def write_ros_map(
    path: str | Path,
    map: QuadtreeMap,
    *,
    resolution: float | None = None,
    occupied: Number = 0.5,
    free: Number = 0.25,
) -> None:
    """Write a map for ROS: a YAML and, beside it, a PGM of the same name.

    White (254) is free, grey (205) unknown, black (0) occupied; row 0 of the picture is the top,
    `origin` the lower left corner of its lower left pixel. Only the part where something is known
    is written.

    Parameters
    ----------
    path : str or Path
        Of the YAML; must end in `.yaml`.
    resolution : float or None
        Side of a pixel: the map's own by default, or this times a power of two. A pixel that holds
        several cells is occupied where one is, and free where all are.
    occupied : float
        Cells of greater occupancy are occupied.
    free : float
        Cells of at most this occupancy are free: by default those that half the `bias` crossed.

    Notes
    -----
    The picture comes first, so that a new YAML never names a picture that is not there.

    Examples
    --------
    >>> import tempfile
    >>> tree = QuadtreeMap(resolution=0.5, size=4, bias=1)
    >>> tree.insert_scan((0.2, 0.2), [(1.2, 0.2)], [(0.2, 1.2)] * 2)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_ros_map(Path(folder) / "it.yaml", tree)
    ...     print((Path(folder) / "it.yaml").read_text().splitlines()[0])
    image: "it.pgm"
    """
    place = arrays.file(path)
    if place.suffix != ".yaml":
        raise ValueError(f"path: the name must end in .yaml, got {place.name!r}")
    classes = ros_classes(map, resolution=resolution, occupied=occupied, free=free)
    rows, columns = classes.greys.shape
    picture, pixels = place.with_suffix(".pgm"), np.flipud(classes.greys).tobytes()
    thresholds = f"free: occupancy <= {free:g}, occupied: occupancy > {occupied:g}"
    lines = [
        f"image: {json.dumps(picture.name, ensure_ascii=False)}",
        f"resolution: {_yaml_number(classes.side)}",
        f"origin: [{_yaml_number(classes.left)}, {_yaml_number(classes.low)}, 0.0]",
        "negate: 0",
        f"occupied_thresh: {OCCUPIED_THRESH}",
        f"free_thresh: {FREE_THRESH}",
        "mode: trinary",
        f"# {thresholds}, else unknown; bias {map.bias}",
    ]
    with rewrite(place) as text, rewrite(picture) as image:  # both can be written, or none is
        image.write(f"P5\n{columns} {rows}\n255\n".encode("ascii") + pixels)
        text.write("".join(f"{line}\n" for line in lines).encode("utf-8", "surrogateescape"))


def _yaml_number(value: float) -> str:
    """A number with a point in it: some YAML readers take 1e-05 for a word."""
    mantissa, mark, power = repr(value).partition("e")
    return mantissa + (".0" if mark and "." not in mantissa else "") + mark + power
