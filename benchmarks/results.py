"""What every method makes of every bundled log, stored in one file; and two such files compared.

    python -m benchmarks.results store BEFORE.npz
    python -m benchmarks.results compare BEFORE.npz AFTER.npz

A change that is not to change any result is held to this. To store the results of another commit,
run this file by its path in a clone of that commit, with `PYTHONPATH=.`.
"""

import sys
import time
from collections.abc import Iterator
from typing import Any

import numpy as np

from segmap import alignment, load, matching, metrics, plan, quadtree, reduction
from segmap.extraction import build_map, extract_polylines
from segmap.scans import Log

LOGS = ("room", "corridor", "malaga")
#: Results that differ by less are equal but for the order of a sum.
ROUNDING = 1e-12
#: Scans that are matched: so many of each log, evenly.
MATCHED_SCANS = 8

#: Of methods that need others than their defaults.
THRESHOLDS = {"ground_truth": {"missing": "drop"}}

Named = Iterator[tuple[str, Any]]


def results() -> Named:
    """All results by name: arrays of numbers, or of words."""
    for name in LOGS:
        log = load(name)
        for what, value in (*aligned(log), *mapped(log)):
            yield f"{name}/{what}", value


def aligned(log: Log) -> Named:
    """Poses of each alignment method, what it says of them, and its loops."""
    for name, method in alignment.METHODS.items():
        found = method(log, **THRESHOLDS.get(name, {}))
        yield f"{name}/poses", found.poses
        yield f"{name}/used", found.used
        yield f"{name}/verdict", str(found.verdict)
        if found.spread is not None:
            yield f"{name}/spread", found.spread
        if found.graph is not None:
            yield f"{name}/edges", found.graph.edges
            yield f"{name}/residuals", found.graph.residuals


def mapped(log: Log) -> Named:
    """Maps at the true poses: segments, reduced by each method, as a quadtree, and as a plan."""
    map = build_map(log, log.truth, keep_points=True)
    yield "segments", map.segments
    for name, method in reduction.METHODS.items():
        reduced = method(map)
        yield f"{name}/segments", reduced.segments
        yield f"{name}/parents", reduced.parents
        yield f"{name}/quality", metrics.quality(map, reduced)
        yield f"{name}/rate", metrics.reduction_rate(map, reduced)
    yield "doubled", metrics.doubled_walls(map)
    tree = quadtree.build_map(log, log.truth, resolution=0.05, free_resolution=0.05)
    yield from ((f"leaves/{field}", row) for field, row in tree.leaves()._asdict().items())
    yield "grid", tree.to_grid()
    yield from matched(log, tree)
    drawn = plan.floor_plan(reduction.one_per_wall(map), tree)
    yield "plan/walls", drawn.walls.segments
    yield "plan/clutter", drawn.clutter.segments
    for k, room in enumerate(drawn.rooms):
        yield f"plan/room {k}", np.vstack([room.outline, room.place, (room.area, room.perimeter)])
    for k, door in enumerate(drawn.doors):
        yield f"plan/door {k}", np.vstack([door.ends, door.rooms])


def matched(log: Log, tree: quadtree.QuadtreeMap) -> Named:
    """Some scans: scored and matched beside the true pose, on the scan before, and anywhere."""
    rng = np.random.default_rng(0)
    placed = np.flatnonzero(np.isfinite(log.truth).all(1))[1:]
    for k in placed[np.linspace(0, len(placed) - 1, MATCHED_SCANS).astype(int)]:
        points, before = log[k].points(), log[k - 1].points()
        starts = log.truth[k] + rng.normal(0, (0.05, 0.05, 0.03), (20, 3))
        for name, score in {**matching.SCORES, "distance": matching.distance_score}.items():
            yield f"scan {k}/{name}", score(tree, points, starts)
        for name, matcher in matching.MATCHERS.items():
            yield f"scan {k}/{name}", matcher(np.random.default_rng(1))(tree, points, starts[0])
        segments = extract_polylines(before), extract_polylines(points)
        for name, match in {
            "match_points": alignment.match_points(before, points),
            "match_segments": alignment.match_segments(*segments),
            "match_angles": alignment.match_angles(*segments, rng=np.random.default_rng(2)),
        }.items():
            yield f"scan {k}/{name}", np.vstack([match.pose, match.covariance])
        places = matching.search(tree, log[k])
        yield f"scan {k}/search", np.column_stack([places.poses, places.scores, places.fits])
    beliefs = matching.localize(tree, log[:MATCHED_SCANS], rng=np.random.default_rng(3))
    yield "localize", np.array([belief.pose for belief in beliefs])


def difference(one: Any, other: Any) -> float:
    """How far two results are apart at most; `inf` where they are no arrays of one kind."""
    if one.shape != other.shape:
        return np.inf
    if np.array_equal(one, other, equal_nan=one.dtype.kind == "f"):
        return 0.0
    if one.dtype.kind not in "fiub":
        return np.inf
    finite = np.isfinite(one) & np.isfinite(other)
    if not np.array_equal(one[~finite], other[~finite], equal_nan=True):
        return np.inf
    return float(np.abs(one[finite].astype(float) - other[finite].astype(float)).max())


def compare(before: str, after: str) -> int:
    """Print what differs, and how many results are equal; 1 where one differs by over 1e-12."""
    with np.load(before) as one, np.load(after) as other:
        both = set(one) & set(other)
        apart = {
            name: difference(one[name], other[name]) if name in both else np.inf
            for name in sorted({*one, *other})
        }
    for name, most in apart.items():
        if most:
            print(f"{name}: {'within' if most <= ROUNDING else 'differs by'} {most:.2g}")
    equal = sum(most == 0 for most in apart.values())
    far = sum(most > ROUNDING for most in apart.values())
    near = len(apart) - equal - far
    print(f"{equal} of {len(apart)} equal to the last bit, {near} within {ROUNDING}, {far} differ")
    return int(far > 0)


def store(path: str) -> int:
    """Store all results in a file, and print each that takes a second or more."""
    found, begun = {}, time.process_time()
    for name, value in results():
        found[name], ended = np.asarray(value), time.process_time()
        if ended - begun > 1:
            print(f"{name}: {ended - begun:.1f} CPU s", flush=True)
        begun = ended
    np.savez_compressed(path, **found)
    print(f"{len(found)} results of {', '.join(LOGS)} in {path}")
    return 0


if __name__ == "__main__":
    sys.exit({"store": store, "compare": compare}[sys.argv[1]](*sys.argv[2:]))
