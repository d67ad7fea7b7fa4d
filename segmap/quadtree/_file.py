"""A tree in a file: written whole or not at all, and checked when it is read."""

from __future__ import annotations

import math
import os
import zipfile
from pathlib import Path
from typing import IO, Any, NamedTuple

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from .._files import RATIO, UNPACKED, existing, replacing
from ..arrays import Array
from . import _loops as loops

FORMAT, VERSION = "segmap quadtree", 1
#: What numpy writes: other ways to pack cannot be unpacked piece by piece.
PACKED = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)


class Stored(NamedTuple):
    """What a file holds."""

    state: NDArray[np.int64]  #: block, level, largest, x and y of the corner, bias, scans
    lengths: Array  #: resolution, x and y of the corner, free resolution or 0, metres
    vis: loops.Counts
    occ: loops.Counts


def write(path: Path, stored: Stored) -> None:
    """Write a file that is whole or absent."""
    kind = np.array(f"{FORMAT} {VERSION}")
    with replacing(path) as target:
        np.savez_compressed(target, format=kind, **stored._asdict())


def read(path: Path) -> Stored:
    """Read a file and check it: compiled loops rely on what it holds."""
    existing(path)
    with path.open("rb") as source:
        try:
            arrays = _arrays(source)
        except Exception as error:  # zipfile, zlib and numpy raise a dozen kinds for damaged bytes
            raise ValueError(f"{path}: not a readable NPZ file ({error})") from None
    kind = str(arrays.pop("format", ""))
    if not kind.startswith(FORMAT):
        raise ValueError(f"{path}: not a quadtree of segmap, holds {sorted(arrays)}")
    if kind != f"{FORMAT} {VERSION}":
        raise ValueError(f"{path}: written as {kind!r}, this version reads {VERSION}")
    if wrong := _fault(arrays):
        raise ValueError(f"{path}: damaged, {wrong}")
    return Stored(**arrays)


# ---------------------------------------------------------------------------- unpacking
def _arrays(source: IO[bytes]) -> dict[str, Any]:
    """The arrays of an NPZ file; nothing is unpacked that is out of proportion to its size."""
    if source.read(2) != b"PK":
        raise ValueError("it does not begin like one")
    most = max(UNPACKED, RATIO * os.fstat(source.fileno()).st_size)
    with zipfile.ZipFile(source) as packed:
        members = packed.infolist()
        if sum(member.file_size for member in members) > most:
            raise ValueError(f"it unpacks to more than {most} bytes")
        if any(member.compress_type not in PACKED for member in members):
            raise ValueError("it is packed as numpy never does")
        return {m.filename.removesuffix(".npy"): _array(packed, m) for m in members}


def _array(packed: zipfile.ZipFile, member: zipfile.ZipInfo) -> NDArray[Any]:
    """One array; its header must not ask for more than there is."""
    with packed.open(member) as source:
        if npy.read_magic(source) != (1, 0):
            raise ValueError(f"{member.filename} is of another version of NPY")
        shape, _, kind = npy.read_array_header_1_0(source)
        data = source.read()
    if kind.hasobject or math.prod(shape) * kind.itemsize != len(data):
        raise ValueError(f"{member.filename} holds {len(data)} bytes, no {kind} {shape}")
    return np.frombuffer(bytearray(data), kind).reshape(shape)


# ------------------------------------------------------------------------------- checks
def _fault(arrays: dict[str, Any]) -> str:
    """What keeps the arrays from being a map; empty where nothing does."""
    if set(arrays) != set(Stored._fields):
        return f"it holds {sorted(arrays)}, expected {sorted(Stored._fields)}"
    state, lengths, vis, occ = (arrays[name] for name in Stored._fields)
    kinds = [(state, np.int64, 7), (lengths, np.float64, 4), (vis, np.int32, vis.size)]
    for array, kind, count in [*kinds, (occ, np.int32, vis.size)]:
        if array.dtype != kind or array.shape != (count,):
            return f"an array is {array.dtype} {array.shape}, expected {np.dtype(kind)} ({count},)"
    block, level, largest, x, y, bias, scans = state.tolist()
    sizes = np.isfinite(lengths).all() and lengths[0] > 0 and 2 <= level <= largest < loops.DEPTH
    # the root holds the square that it grew from, whose corner is cell 0, 0
    counts = bias >= 1 and 0 <= scans < loops.FAR
    if not (sizes and counts and all(0 <= -at < 1 << level for at in (x, y))):
        return "its sizes make no sense"
    return _fault_of_blocks(vis, block) or _fault_of_leaves(vis, occ, block, level)


def _fault_of_blocks(vis: loops.Counts, root: int) -> str:
    """Every block must be reached once, from the root, and in the order that the loops expect."""
    blocks, inner = vis.size // 4, np.flatnonzero(vis < 0)
    above, child = inner // 4, ~vis[inner].astype(np.int64)
    if vis.size % 4 or not np.array_equal(np.sort(np.append(child, root)), np.arange(blocks)):
        return "its blocks do not hang together"
    # blocks come after the one above, but for roots that were doubled
    late = child < above
    doubled = dict(zip(above[late].tolist(), child[late].tolist(), strict=True))
    count = len(doubled)
    while root in doubled:
        root = doubled.pop(root)
    return "its blocks are out of order" if doubled or late.sum() > count else ""


def _fault_of_leaves(vis: loops.Counts, occ: loops.Counts, root: int, level: int) -> str:
    """No leaf is smaller than a cell, only cells hold ends, and counts are possible."""
    inner = vis < 0
    if (occ < 0).any() or (occ > vis)[~inner].any() or occ[inner].any():
        return "a leaf was hit more often than crossed"
    layer, seen = np.array([root]), 0
    while len(layer):
        level, seen = level - 1, seen + len(layer)
        if level < 0:
            return "a leaf is smaller than a cell"
        nodes = (4 * layer[:, None] + np.arange(4)).ravel()
        if level > 0 and occ[nodes].any():
            return "a leaf larger than a cell was hit"
        layer = ~vis[nodes[vis[nodes] < 0]].astype(np.int64)
    return "" if seen == len(vis) // 4 else "its blocks do not hang together"
