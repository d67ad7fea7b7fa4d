"""Reduction and quality: seconds, and ratios to the plain methods in one run."""

from collections.abc import Iterator

import numpy as np
from segmap_course import literal

from segmap import METHODS, SegmentMap, build_map, fusion, load, quality, read, reduction_rate
from segmap.threads import cores

from .measure import SHARED, Row, missing, on_cores, once, seconds, workloads

N = 3604


#: What each method has to reach at n = 3604.
TARGETS = {
    "basic_offline": "<= 6 ms",
    "basic_online": "<= 50 ms",
    "hybrid": "<= 10 ms",
    "mean_shift": "<= 200 ms on two cores",
    "fusion": "<= 50 ms",
    "least_cost": "<= 150 ms at 20",
    "segment_similarity": "<= 200 ms",
} | dict.fromkeys(
    (
        "fuzzy_clustering",
        "fuzzy_set",
        "polyline",
        "uncertain_parameters",
        "viewing_sector",
        "weighted_line_fitting",
    ),
    "<= 100 ms",
)


def rows() -> Iterator[Row]:
    yield from real_maps()
    made = workloads()
    if made is None:
        yield from missing("redundant maps")
        return
    for seen in (20, 3):
        yield from same_size(made, seen)
        yield from against_literal(made, seen)


#: Methods whose plain forms take minutes to hours for this many segments.
SLOW = ("mean_shift", "segment_similarity", "least_cost")


def same_size(made, seen: int) -> Iterator[Row]:
    map, what = redundant(made, N, seen), f"n = {N}, seen {seen}"
    for name, method in METHODS.items():
        took = seconds(lambda: method(map))  # noqa: B023
        yield Row(
            f"{name}, {what}",
            f"{1e3 * took:.1f} ms -> {len(method(map))}",
            TARGETS.get(name, ""),
        )
    figure, threads = on_cores(lambda: METHODS["mean_shift"](map)), f"one thread / {cores()}"
    yield Row(f"mean_shift, {what}, {threads}", figure, "200 ms on two quiet cores")
    after = part_of(map)
    took = seconds(lambda: quality(map, after))
    yield Row(f"quality against 700, {what}", f"{1e3 * took:.1f} ms", "<= 100 ms")
    yield Row(f"quality, {what}, {threads}", on_cores(lambda: quality(map, after)))


def part_of(map: SegmentMap) -> np.ndarray:
    """700 segments of a map, by chance."""
    return map.segments[np.random.default_rng(0).permutation(len(map))[:700]]


def redundant(made, n: int, seen: int) -> SegmentMap:
    """A building of n segments; a scan is one visit to all of its walls, seen from amid them."""
    segments = made.redundant_segments(n, seen=seen)[0].reshape(-1, 2, 2)
    scan = np.arange(n) // max(n // seen, 4)
    places = [segments[scan == k].mean((0, 1)) for k in range(scan[-1] + 1)]
    return SegmentMap(segments, scan, sensors=places)


def real_maps() -> Iterator[Row]:
    logs = [load("malaga")]
    path = SHARED / "data" / "intel.log.gz"
    if path.exists():
        intel = read(path)
        logs += [intel[::4], intel]
    for log in logs:
        map, threads = build_map(log, log.truth), f"one thread / {cores()}"
        took = on_cores(lambda log=log: build_map(log, log.truth))
        yield Row(f"build_map, {log.name}, {len(log)} scans, {threads}", took)
        found = fusion(map)
        used = len(np.unique(map.scan))
        yield Row(
            f"fusion at 40 mm, {log.name}, {used} scans",
            f"{len(map)} -> {len(found)}, reduction {reduction_rate(map, found):.4f}, "
            f"quality {quality(map, found):.4f}, {1e3 * seconds(lambda m=map: fusion(m)):.1f} ms",
        )


def against_literal(made, seen: int) -> Iterator[Row]:
    """The same work by the plain forms of `segmap_course.literal`, at full size, once each."""
    map = redundant(made, N, seen)
    s, scans, after = map.segments.tolist(), map.scan.tolist(), part_of(map)
    for name, method in METHODS.items():
        plain = getattr(literal, name)
        if name not in SLOW and plain is not method.function:
            given = (s, scans) if method.online else (s,)
            yield ratio(name, lambda: plain(*given), lambda: method(map), seen)  # noqa: B023
    yield ratio(
        "quality", lambda: literal.quality(s, after.tolist()), lambda: quality(map, after), seen
    )


def ratio(name: str, plain, ours, seen: int) -> Row:
    a, b = once(plain), seconds(ours)
    figure = f"{a:.1f} s / {1e3 * b:.1f} ms = {a / b:.0f}"
    return Row(f"{name}, literal / ours, n = {N}, seen {seen}", figure)
