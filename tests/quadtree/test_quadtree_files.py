"""A quadtree on disk: it comes back bit for bit, or says what is wrong with the file."""

import numpy as np
import pytest
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


TAMPERED = {
    "another version": ({"format": np.array("segmap quadtree 9")}, "this version reads 1"),
    "another kind": ({"format": np.array("cat")}, r"not a quadtree of segmap, holds \['lengths'"),
    "no format": ({"format": None}, "not a quadtree of segmap"),
    "no counts": ({"vis": None}, r"it holds \['lengths', 'occ', 'state'\]"),
    "one more": ({"more": np.zeros(1)}, "it holds.*'more'"),
    "pickled": ({"vis": np.array([{}], object)}, "not a readable NPZ file"),
}


@pytest.mark.parametrize("name", TAMPERED)
def test_a_file_that_is_no_tree_is_refused(name, saved, tmp_path):
    changes, message = TAMPERED[name]
    path = tmp_path / "tampered.npz"
    kept = {name: array for name, array in (parts(saved) | changes).items() if array is not None}
    np.savez(path, **kept)
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


def test_a_small_file_does_not_fill_the_memory(saved, tmp_path):
    """2 MB of NPZ would become 2.9 GB."""
    path = tmp_path / "it.npz"
    np.savez_compressed(path, **parts(saved) | {"vis": np.zeros(5 * 10**6, np.int32)})
    with pytest.raises(ValueError, match=r"it\.npz: .*it unpacks to more than 1048576 b"):
        QuadtreeMap.load(path)


def test_the_most_regular_tree_is_no_bomb(tmp_path):
    """Catches a bound that a map of our own meets: 4^8 leaves that nothing has crossed."""
    map, blocks = QuadtreeMap(resolution=1, size=2**8), (4**8 - 1) // 3
    map.tree.vis, map.tree.occ = np.zeros((2, 4 * blocks), np.int32)
    map.tree.vis[: blocks - 1], map.tree.used = ~np.arange(1, blocks, dtype=np.int32), blocks
    map.save(tmp_path / "full.npz")
    assert len(QuadtreeMap.load(tmp_path / "full.npz").leaves().x) == 4**8
