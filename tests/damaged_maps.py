"""Maps as NPZ files that a careless or hostile program may have written, and what must hold then.

The zip file is sound, so only a check of what it holds can tell.
"""

import random
from contextlib import suppress
from functools import cache

import numpy as np

from segmap.matching import (
    DistanceField,
    descent_score,
    distance_score,
    nearest_score,
    occupancy_score,
)
from segmap.quadtree import QuadtreeMap

ODD = [0, 1, -1, 2, 3, 4, 15, 16, 31, 32, 63, 2**31 - 1, -(2**31), 2**60, -(2**60), 2**63 - 1]
ODD += [-(2**63), 5, 20, -2, -3]
ODD_LENGTHS = [0.0, -0.0, 0.01, 1e-6, 1e-9, 1e-300, 5e-324, 1e7, 1e8, 1e300, -1.0, 0.02, 0.03]
ODD_LENGTHS += [np.inf, -np.inf, np.nan]
#: Ends of a scan in the robot's frame, and poses; some far from any map.
POINTS = np.array([(0.1, 0.0), (0.5, 0.3), (-0.4, 0.2), (3.0, -2.0), (1e6, -1e6)])
POSES = np.array([(0.0, 0.0, 0.0), (0.3, 0.2, 1.0), (-50.0, 20.0, 3.0)])


@cache
def sound() -> dict:
    """What the file of a small map with all kinds of leaves holds."""
    map = QuadtreeMap(resolution=0.05, size=0.8, corner=(0.1, -0.2), bias=7)
    rng = np.random.default_rng(8)
    for _ in range(2):
        map.insert_scan(rng.uniform(0, 0.5, 2), rng.uniform(-1, 2, (12, 2)), [(0.2, 2.0)])
    tree = map.tree
    state = [tree.block, tree.level, tree.largest, *tree.corner, map.bias, map.scans]
    nodes = {"vis": tree.vis[: 4 * tree.used], "occ": tree.occ[: 4 * tree.used]}
    return {"state": np.array(state), "lengths": np.array([0.05, 0.1, -0.2, 0.0]), **nodes}


def grown(rng: random.Random) -> dict:
    """A tree of random shape: hits may lie in leaves of any size, blocks in any order."""
    vis, occ, todo, level = [], [], [0], rng.randint(2, 9)
    blocks = rng.choice([1, 2, 5, 20])
    while todo:
        todo.pop(rng.randrange(len(todo)))
        for _ in range(4):
            if len(vis) // 4 + len(todo) + 1 < blocks and rng.random() < 0.4:
                todo.append(0)
                vis.append(-1 - len(vis) // 4 - len(todo))
                occ.append(0)
            else:
                vis.append(rng.choice([0, 1, 5, 5, 2**31 - 1]))
                occ.append(rng.choice([0, 0, 0, 1, 5]) if vis[-1] else 0)
    state = [0, level, rng.choice([level, 16, 31]), 0, 0, 20, 1]
    found = {"state": np.array(state), "lengths": np.array([0.05, 0.0, 0.0, 0.0])}
    return found | {"vis": np.array(vis, np.int32), "occ": np.array(occ, np.int32)}


def chain(rng: random.Random) -> dict:
    """A tree down to single cells, some of which were hit; its blocks may be renumbered."""
    level = rng.randint(2, 8)
    vis, occ = np.full(4 * level, 3, np.int32), np.zeros(4 * level, np.int32)
    order = list(range(level))
    if rng.random() < 0.5:
        rng.shuffle(order)
    for depth in range(level - 1):
        vis[4 * order[depth] + rng.randrange(4)] = ~order[depth + 1]
    occ[4 * order[-1] + rng.randrange(4)] = rng.choice([1, 2, 3])
    state = [order[0], level, level, 0, 0, 20, 1]
    found = {"state": np.array(state), "lengths": np.array([0.05, 0.0, 0.0, 0.0])}
    return found | {"vis": vis, "occ": occ}


# ------------------------------------------------------------------------------ changes
def set_one(arrays, rng):
    name = rng.choice(list(arrays))
    array = arrays[name]
    odd = ODD_LENGTHS if array.dtype.kind == "f" else ODD
    fits = [v for v in odd if array.dtype.kind == "f" or np.iinfo(array.dtype).min <= v]
    fits = [v for v in fits if array.dtype.kind == "f" or v <= np.iinfo(array.dtype).max]
    if array.size:
        array[rng.randrange(array.size)] = rng.choice(fits)


def swap_two(arrays, rng):
    array = arrays[rng.choice(list(arrays))]
    if array.size:
        a, b = rng.randrange(array.size), rng.randrange(array.size)
        array[[a, b]] = array[[b, a]]


def swap_fields(arrays, rng):
    a, b = rng.sample(list(arrays), 2)
    arrays[a], arrays[b] = arrays[b], arrays[a]


def renumber(arrays, rng):
    """The same tree with its blocks in another order."""
    vis, occ, state = arrays["vis"], arrays["occ"], arrays["state"]
    count = len(vis) // 4
    if vis.dtype != np.int32 or occ.size != vis.size or len(vis) % 4 or (~vis >= count).any():
        return
    order = np.array(rng.sample(range(count), count), np.int64)
    new_vis, new_occ = vis.reshape(-1, 4).copy(), occ.reshape(-1, 4).copy()
    new_vis[order], new_occ[order] = vis.reshape(-1, 4), occ.reshape(-1, 4)
    inner = new_vis < 0
    new_vis[inner] = ~order[~new_vis[inner]]
    arrays["vis"], arrays["occ"] = new_vis.ravel(), new_occ.ravel()
    if state.size and 0 <= state[0] < count:
        state[0] = order[int(state[0])]


def cut_short(arrays, rng):
    name = rng.choice(list(arrays))
    arrays[name] = arrays[name][: -rng.choice([1, 4])]


def repeat(arrays, rng):
    for name in rng.choice([("vis", "occ"), ("vis",), ("state",)]):
        arrays[name] = np.concatenate([arrays[name], arrays[name][:4]])


def other_kind(arrays, rng):
    name = rng.choice(list(arrays))
    with np.errstate(all="ignore"):
        arrays[name] = arrays[name].astype(rng.choice([np.int64, np.int32, np.float64, bool, "U9"]))


def leave_out(arrays, rng):
    arrays.pop(rng.choice(list(arrays)))


CHANGES = [set_one] * 6 + [swap_two] * 3 + [swap_fields, renumber, renumber]
LAST = [cut_short, repeat, other_kind, leave_out]


def damaged(rng: random.Random) -> dict:
    """The arrays of a file: of a random tree, or of a sound one, with up to three changes."""
    start = rng.choice([sound, sound, lambda: grown(rng), lambda: chain(rng)])()
    arrays = {name: array.copy() for name, array in start.items()}
    for _ in range(rng.randint(0, 3)):
        rng.choice(CHANGES)(arrays, rng)
    if rng.random() < 0.1:
        rng.choice(LAST)(arrays, rng)
    return arrays


def write(path, arrays: dict) -> None:
    np.savez(path, format=np.array("segmap quadtree 1"), **arrays)


def outcome(path) -> QuadtreeMap | None:
    """The map, which everything works on that asks a map; None where the file was refused."""
    try:
        map = QuadtreeMap.load(path)
    except ValueError as fault:
        assert str(path) in str(fault)
        return None
    leaves = map.leaves()
    assert leaves.side[leaves.occ > 0].max(initial=0.0) <= map.resolution
    assert leaves.side.min() >= map.resolution
    middle = np.array([*map.bounds[:2]]) + map.side / 2
    poses = POSES + [*middle, 0.0]
    map.occupancy(POINTS + middle)
    _goes_on(path, map, middle)
    if not (2.0 * leaves.occ > leaves.vis).any():
        return map
    map = QuadtreeMap.load(path)
    exact = distance_score(map, POINTS, poses)
    np.testing.assert_allclose(nearest_score(map, POINTS, poses), exact, rtol=1e-6, atol=1e-6)
    assert (descent_score(map, POINTS, poses) <= exact * (1 - 1e-6) + 1e-6).all()
    assert (occupancy_score(map, POINTS, poses) >= 0).all()
    hit = np.argmax(2.0 * leaves.occ > leaves.vis)
    for window in (None, [*middle - map.side / 5, *middle + map.side / 5]):
        _field(map, window, poses)
    corner = np.array([leaves.x[hit], leaves.y[hit]])
    _field(map, [*corner - 1.5 * map.resolution, *corner + 2 * map.resolution], poses)
    return map


def _goes_on(path, map, middle):
    """A map that was loaded grows, is saved and comes back."""
    before = path.read_bytes()
    with suppress(ValueError):  # beyond max_size
        map.insert_scan(middle, POINTS[:4] + middle, [middle - 1.0])
    map.save(path)
    assert np.array_equal(QuadtreeMap.load(path).tree.vis, map.tree.vis[: 4 * map.tree.used])
    path.write_bytes(before)


def _field(map, window, poses):
    try:
        field = DistanceField(map, window)
    except ValueError:
        return
    assert (field.cells >= 0).all() and (field.score(POINTS, poses) <= 0).all()
