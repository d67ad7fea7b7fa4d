"""Objects that two threads use at once: run as `hammered.py SEED SECONDS PAIR...`."""

import contextlib
import pickle
import sys
import threading
import time
from copy import deepcopy

import numpy as np

from segmap import load
from segmap.alignment import LiveGraph
from segmap.exports import ros_classes
from segmap.extraction import extract_polylines
from segmap.matching import DistanceField, LiveMap, NoRoute, nearest_score, route
from segmap.poses import transform
from segmap.quadtree import QuadtreeMap, extent, frontiers
from segmap.reduction import LiveReduction

LOG = load("room")
WALLS = [
    transform(pose, extract_polylines(scan.points()).reshape(-1, 2)).reshape(-1, 2, 2)
    for scan, pose in zip(LOG, LOG.truth, strict=True)
]


def map_of(seed):
    """A map of rather small leaves, which grows, splits and joins; odd seeds keep it coarse."""
    return QuadtreeMap(resolution=0.05, size=1.6, free_resolution=None if seed % 2 else 0.2)


def insert(map, rng):
    """A scan from anywhere: farther and farther out, so that the root doubles and arrays grow."""
    sensor = rng.normal(0, 1 + map.scans / 50, 2)
    angle, away = rng.uniform(0, 2 * np.pi, 200), rng.uniform(0.1, 6, 200)
    map.insert_scan(sensor, sensor + np.stack([np.cos(angle), np.sin(angle)], -1) * away[:, None])
    if map.scans > 200:  # large ones take their readers too long
        fresh = map_of(int(rng.integers(2)))
        insert(fresh, rng)  # an empty map has no score
        map.become(fresh)


def whole(map):
    """Whether a map is one: its leaves cover the root, and no more rays end than cross."""
    leaves = map.leaves()
    squares = np.log2((leaves.side / map.resolution) ** 2 @ np.ones(len(leaves.side))) / 2
    assert squares == round(squares) and (leaves.occ <= leaves.vis).all()


def find_way(map, points):
    with contextlib.suppress(NoRoute):
        route(map, points[0], points[1], radius=0.05)


#: What runs a loop on the tree of a map.
LOOKS = [
    lambda map, points: whole(map),
    lambda map, points: map.to_grid(value="variance"),
    lambda map, points: (map.occupancy(points), map.leaf_occupancy()),
    lambda map, points: whole(deepcopy(pickle.loads(pickle.dumps(map))).cropped(-1, -1, 1, 1)),
    lambda map, points: (nearest_score(map, points, np.zeros((3, 3))), extent(map)),
    lambda map, points: (map.tree.leaves(), DistanceField(map), ros_classes(map)),
    lambda map, points: frontiers(map),
    find_way,
]


def look(map, rng):
    LOOKS[rng.integers(len(LOOKS))](map, rng.uniform(-5, 5, (50, 2)))


def ask(graph, rng):
    """Ask a graph for all that it knows."""
    graph.poses, graph.graph, graph.loops(), repr(graph)
    if rng.random() < 0.1:
        graph.refine()


def follow(live, rng):
    """Ask a live map for what a page shows, and its map for everything."""
    assert np.isfinite(live.poses).all() and np.isfinite(live.walls.segments).all()
    look(live.map, rng)


#: What is made, what changes it, and what asks it.
KINDS = {
    "map": (map_of, insert, look),
    "graph": (
        lambda seed: LiveGraph(),
        lambda graph, rng: graph.add(LOG[len(graph) % len(LOG)]),
        ask,
    ),
    "walls": (
        lambda seed: LiveReduction(every=7),
        lambda walls, rng: walls.add(WALLS[rng.integers(len(WALLS))] + rng.normal(0, 0.5, 2)),
        lambda walls, rng: (deepcopy(walls).segments, repr(walls)),
    ),
    "live map": (
        lambda seed: LiveMap(map=map_of(0), walls=LiveReduction()),
        lambda live, rng: live.add(LOG[rng.integers(len(LOG))]),
        follow,
    ),
}


def hammer(pair, seed, seconds):
    """Let two threads work on one object; how often each did, or the first error."""
    kind, second = pair.split(", ")
    make, write, read = KINDS[kind]
    thing, steps, errors = make(seed), [0, 0], []
    for step in (write, read) * 8:  # loads the loops, and what is empty has no score
        step(thing, np.random.default_rng(seed))
    end = time.monotonic() + seconds

    def work(own, step):
        rng = np.random.default_rng([seed, own])
        try:
            while time.monotonic() < end and not errors:
                step(thing, rng)
                steps[own] += 1
        except BaseException as error:
            errors.append(error)

    works = [(0, write), (1, write if second == "writers" else read)]
    threads = [threading.Thread(target=work, args=one) for one in works]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for error in errors:
        raise error
    if isinstance(thing, QuadtreeMap):
        whole(thing)
    return steps


if __name__ == "__main__":
    for pair in sys.argv[3:]:
        print(*hammer(pair, int(sys.argv[1]), float(sys.argv[2])))
