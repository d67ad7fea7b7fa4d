"""A quadtree as an NPZ file: checked when read, whole or absent when written."""

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ._loops import DEPTH, FAR
from ._tree import in_use

if TYPE_CHECKING:
    from ._map import QuadtreeMap

FORMAT, VERSION = "segmap quadtree", 1


class Stored(NamedTuple):
    """What the file holds: whole numbers, lengths in metres, and the counts of the nodes."""

    state: NDArray[np.int64]
    lengths: Array
    vis: NDArray[np.int32]
    occ: NDArray[np.int32]


def write_npz(path: Path, **arrays: Any) -> None:
    """Write arrays under a temporary name, then rename."""
    if not path.parent.is_dir():
        raise FileNotFoundError(f"cannot write {path}: the folder {path.parent} does not exist")
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        with part.open("wb") as target:
            np.savez_compressed(target, format=np.array(f"{FORMAT} {VERSION}"), **arrays)
            target.flush()
            os.fsync(target.fileno())
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)


def write_map(path: Path, map: "QuadtreeMap") -> None:
    """Write a map: whole or not at all."""
    tree = map.tree
    state = np.array([tree.block, tree.level, tree.largest, *tree.corner, map.bias, map.scans])
    lengths = np.array([map.resolution, *map.corner, map.free_resolution or 0.0])
    vis, occ = in_use(tree)
    write_npz(path, state=state, lengths=lengths, vis=vis, occ=occ)


def read_map(path: Path, kind: type["QuadtreeMap"]) -> "QuadtreeMap":
    """The map in a file.

    Raises
    ------
    ValueError
        For a damaged or foreign file, saying what is wrong with it.
    """
    found = read_npz(path)
    resolution, x, y, free = found.lengths.tolist()
    block, level, largest, cell_x, cell_y, bias, scans = found.state.tolist()
    sizes = {"size": np.ldexp(resolution, level), "max_size": np.ldexp(resolution, largest)}
    options = {"corner": (x, y), "bias": bias, "free_resolution": free or None}
    try:
        map = kind(resolution=resolution, **sizes, **options)
    except ValueError as error:
        raise ValueError(f"{path}: damaged, {error}") from None
    map.scans, tree = scans, map.tree
    tree.vis, tree.occ, tree.used, tree.block = found.vis, found.occ, len(found.vis) // 4, block
    tree.corner = np.array([cell_x, cell_y], np.int64)
    return map


def read_npz(path: Path) -> Stored:
    """Read and check a file.

    Raises
    ------
    ValueError
        For a damaged or foreign file, saying what is wrong with it.
    """
    try:
        with path.open("rb") as source:
            if source.read(2) != b"PK":  # else numpy would speak of pickles
                raise ValueError("it does not begin like one")
            source.seek(0)
            with np.load(source, allow_pickle=False) as held:
                arrays: dict[str, Any] = {name: held[name] for name in held.files}
    except (FileNotFoundError, IsADirectoryError, PermissionError):
        raise
    except Exception as error:  # zipfile, zlib and numpy raise a dozen kinds for damaged bytes
        raise ValueError(f"{path}: not a readable NPZ file ({error})") from None
    kind = str(arrays.pop("format", ""))
    if not kind.startswith(FORMAT):
        raise ValueError(f"{path}: not a quadtree of segmap, holds {sorted(arrays)}")
    if kind != f"{FORMAT} {VERSION}":
        raise ValueError(f"{path}: written as {kind!r}, this version reads {VERSION}")
    if wrong := _what_is_wrong(arrays):
        raise ValueError(f"{path}: damaged, {wrong}")
    return Stored(**arrays)


def _what_is_wrong(arrays: dict[str, Any]) -> str:
    """What keeps the arrays from being a tree; empty where nothing does."""
    if set(arrays) != set(Stored._fields):
        return f"it holds {sorted(arrays)}, expected {sorted(Stored._fields)}"
    state, lengths, vis, occ = (arrays[name] for name in Stored._fields)
    kinds = [(state, np.int64, 7), (lengths, np.float64, 4), (vis, np.int32, vis.size)]
    for array, kind, count in [*kinds, (occ, np.int32, vis.size)]:
        if array.dtype != kind or array.shape != (count,):
            return f"an array is {array.dtype} {array.shape}, expected {np.dtype(kind)} ({count},)"
    _, level, largest, _, _, bias, scans = state.tolist()
    sizes = np.isfinite(lengths).all() and lengths[0] > 0 and 2 <= level <= largest < DEPTH
    if not (sizes and bias >= 1 and scans >= 0 and (abs(state[3:5]) < FAR).all()):
        return "its sizes make no sense"
    return _what_is_wrong_with_tree(vis, occ, int(state[0]), int(state[1]))


def _what_is_wrong_with_tree(
    vis: NDArray[np.int32], occ: NDArray[np.int32], root: int, level: int
) -> str:
    """Every block must be reached once, from the root, and counts must be possible."""
    blocks = vis.size // 4
    inner = vis < 0
    child = np.append(~vis[inner].astype(np.int64), root)
    if vis.size % 4 or not np.array_equal(np.sort(child), np.arange(blocks)):
        return "its blocks do not hang together"
    if (occ < 0).any() or (occ > vis)[~inner].any() or occ[inner].any():
        return "a leaf was hit more often than crossed"
    layer, depth, seen = np.array([root]), 0, 1
    while len(layer):
        nodes = (4 * layer[:, None] + np.arange(4)).ravel()
        layer = ~vis[nodes[vis[nodes] < 0]].astype(np.int64)
        depth, seen = depth + 1, seen + len(layer)
        if depth > level:
            return "a leaf is smaller than a cell"
    return "" if seen == blocks else "its blocks do not hang together"
