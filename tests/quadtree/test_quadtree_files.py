"""A quadtree on disk: it comes back bit for bit, or says what is wrong with the file."""

import random
import tracemalloc
import zipfile
from functools import partial

import damaged_maps
import numpy as np
import pytest
from conftest import slow
from damage import MUTANTS
from numpy.lib import format as npy
from quadtrees import leaves_of, state

from segmap.quadtree import QuadtreeMap


def example(**options) -> QuadtreeMap:
    """Grown to the left and downwards, with counts of all kinds."""
    map = QuadtreeMap(resolution=0.05, size=0.8, corner=(0.1, -0.2), bias=7, **options)
    rng = np.random.default_rng(8)
    for _ in range(3):
        map.insert_scan(rng.uniform(0, 0.5, 2), rng.uniform(-1, 2, (20, 2)), [(0.2, 2.0)])
    return map


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    path = tmp_path_factory.mktemp("maps") / "map.npz"
    example().save(path)
    return path


@pytest.mark.parametrize("options", [{}, {"free_resolution": 0.1}, {"max_size": 0.8 * 2**9}])
def test_a_map_comes_back_and_goes_on(options, tmp_path):
    """Catches an option, a corner or a count that the file forgets, and bytes that vary."""
    map = example(**options)
    map.save(tmp_path / "map.npz")
    found = QuadtreeMap.load(tmp_path / "map.npz")
    found.save(tmp_path / "again.npz")
    assert (tmp_path / "again.npz").read_bytes() == (tmp_path / "map.npz").read_bytes()
    assert state(found) == state(map) and found.bounds == map.bounds
    for each in (map, found):
        each.insert_scan((0.3, 0.3), [(-3, 5), (0.4, 0.4)])
        with pytest.raises(ValueError, match="max_size"):
            each.insert_scan((0, 0), [(0.8 * 2**16 if "max_size" not in options else 500, 0)])
    assert leaves_of(found) == leaves_of(map)
    assert (found.bias, found.free_resolution) == (7, options.get("free_resolution"))


def parts(path) -> dict:
    with np.load(path) as held:
        return {name: held[name] for name in held.files}


#: All cells of a large leaf hit: the distance field wrote outside of its array.
HITS = {
    **{"vis": np.full(4, 5, np.int32), "occ": np.full(4, 5, np.int32)},
    **{"state": np.array([0, 16, 16, 0, 0, 20, 1]), "lengths": np.array([0.01, 0, 0, 0])},
}
TAMPERED = {
    "another version": ({"format": np.array("segmap quadtree 9")}, "this version reads 1"),
    "another kind": ({"format": np.array("cat")}, r"not a quadtree of segmap, holds \['lengths'"),
    "no format": ({"format": None}, "not a quadtree of segmap"),
    "no counts": ({"vis": None}, "expected.*'vis'"),
    "one more": ({"more": np.zeros(1)}, "it holds.*'more'"),
    "floats": ({"vis": np.zeros(8)}, r"an array is float64 \(8,\), expected int32"),
    "other length": ({"occ": np.zeros(5, np.int32)}, "an array is int32"),
    "pickled": ({"vis": np.array([{}], object)}, "not a readable NPZ file"),
    "a cycle": ({"vis": (0, -1)}, "its blocks do not hang together"),
    "a block twice": ({"vis": (1, "another's")}, "its blocks do not hang together"),
    "a block beyond": ({"vis": (0, -9999)}, "its blocks do not hang together"),
    "half a block": ({"vis": 1, "occ": 1}, "its blocks do not hang together"),
    "hit but not crossed": ({"occ": ("leaf", 99)}, "hit more often than crossed"),
    "hit below zero": ({"occ": ("leaf", -1)}, "hit more often than crossed"),
    "an inner hit": ({"occ": ("inner", 1)}, "hit more often than crossed"),
    "too deep": ({"state": ("level", (2, 0, 0))}, "a leaf is smaller than a cell"),
    "more scans than can be counted": ({"state": (6, 2**62)}, "its sizes make no sense"),
    "a corner that the root lost": ({"state": (3, 1)}, "its sizes make no sense"),
    "a corner that has no opposite": ({"state": (3, -(2**63))}, "its sizes make no sense"),
    "cells too small": ({"lengths": (0, 1e-300)}, "damaged, resolution must be"),
    "a corner beyond all maps": ({"lengths": (1, 1e200)}, "damaged, corner must be within"),
    "root above the largest": ({"state": (2, 3)}, "its sizes make no sense"),
    "root too large": ({"state": (1, 99)}, "its sizes make no sense"),
    "hits in a large leaf": (HITS, "a leaf larger than a cell"),
    "no bias": ({"state": (5, 0)}, "its sizes make no sense"),
    "scans below zero": ({"state": (6, -1)}, "its sizes make no sense"),
    "corner far off": ({"state": (3, 2**62)}, "its sizes make no sense"),
    "endless cells": ({"lengths": (0, np.inf)}, "its sizes make no sense"),
    "cells below zero": ({"lengths": (0, -1.0)}, "its sizes make no sense"),
    "odd free_resolution": ({"lengths": (3, 0.07)}, "free_resolution must be a power of two"),
}


def tampered(arrays: dict, changes: dict) -> dict:
    inner = np.flatnonzero(arrays["vis"] < 0)
    nodes = {"leaf": np.flatnonzero(arrays["vis"] >= 0)[0], "inner": inner[0]}
    for name, change in changes.items():
        array = arrays.get(name)
        if isinstance(change, tuple):
            at, value = change
            at = [1, 3, 4] if at == "level" else inner[at] if name == "vis" else nodes.get(at, at)
            array[at] = array[inner[2]] if isinstance(value, str) else value
        else:
            arrays[name] = array[:-change] if isinstance(change, int) else change
    return {name: array for name, array in arrays.items() if array is not None}


@pytest.mark.parametrize("name", TAMPERED)
def test_a_file_that_is_no_tree_is_refused(name, saved, tmp_path):
    """Sound zip files, so only a check of what they hold can tell; a cycle would never end."""
    changes, message = TAMPERED[name]
    path = tmp_path / "tampered.npz"
    np.savez(path, **tampered(parts(saved), changes))
    with pytest.raises(ValueError, match=rf"tampered\.npz: .*{message}"):
        QuadtreeMap.load(path)


@pytest.mark.parametrize("data", [b"", b"PK", b"FLASER 3 1 1", b"\x93NUMPY\x01\x00", b"\x80\x04N."])
def test_another_file_is_refused(data, tmp_path):
    """Without a word of pickles: numpy advises to allow them, nobody shall."""
    path = tmp_path / "other.npz"
    path.write_bytes(data)
    with pytest.raises(ValueError, match=r"other\.npz: not a readable NPZ file") as caught:
        QuadtreeMap.load(path)
    assert "pickle" not in str(caught.value)


# ------------------------------------------------------------------------ crafted files


@pytest.mark.parametrize("count", [max(500, MUTANTS), slow(1200)])
def test_a_crafted_file_is_refused_or_everything_works_on_its_map(count, tmp_path):
    """Catches an invariant that a loop relies on and that nobody checks."""
    rng, path = random.Random(5), tmp_path / "crafted.npz"
    accepted = 0
    for number in range(count):
        arrays = damaged_maps.damaged(rng)
        damaged_maps.write(path, arrays)
        try:
            accepted += damaged_maps.outcome(path) is not None
        except BaseException as fault:
            fault.add_note(f"mutant {number}: {arrays}")
            raise
    assert accepted > count / 6


def bomb(path):
    """2 MB of NPZ that become 2.9 GB."""
    np.savez_compressed(path, **damaged_maps.sound() | {"vis": np.zeros(5 * 10**6, np.int32)})
    assert path.stat().st_size < 50_000


def packed_otherwise(path):
    """Python's zip files unpack bzip2 without a bound."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_BZIP2) as held:
        held.writestr("vis.npy", bytes(1000))


def asks(path, *, shape):
    """An array that is as large as its header says, before it is read."""
    with zipfile.ZipFile(path, "w") as held, held.open("vis.npy", "w") as member:
        npy.write_array_header_1_0(member, {"descr": "<i4", "fortran_order": False, "shape": shape})
        member.write(bytes(16))


SHAPES = [(2**40,), (2**31, 2**33), (-1,), (3,)]


@pytest.mark.parametrize(
    ("write", "reason"),
    [
        (bomb, "unpacks to more than 1048576 bytes"),
        (packed_otherwise, "as numpy never does"),
        *((partial(asks, shape=s), r"vis\.npy holds 16 bytes, no int32") for s in SHAPES),
    ],
)
def test_a_small_file_does_not_fill_the_memory(write, reason, tmp_path):
    write(tmp_path / "it.npz")
    tracemalloc.start()
    with pytest.raises(ValueError, match=rf"it\.npz: not a readable NPZ file \(.*{reason}"):
        QuadtreeMap.load(tmp_path / "it.npz")
    assert tracemalloc.get_traced_memory()[1] < 8e6
    tracemalloc.stop()


def test_the_most_regular_tree_is_no_bomb(tmp_path):
    """Catches a bound that a map of our own meets: 4^8 leaves that nothing has crossed."""
    map, blocks = QuadtreeMap(resolution=1, size=2**8), (4**8 - 1) // 3
    map.tree.vis, map.tree.occ = np.zeros((2, 4 * blocks), np.int32)
    map.tree.vis[: blocks - 1], map.tree.used = ~np.arange(1, blocks, dtype=np.int32), blocks
    map.save(tmp_path / "full.npz")
    assert len(QuadtreeMap.load(tmp_path / "full.npz").leaves().x) == 4**8
