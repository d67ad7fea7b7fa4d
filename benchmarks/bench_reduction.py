"""Fusion and quality: seconds, growth, and ratios to the literal references in one run."""

from collections.abc import Iterator

import numpy as np

from segmap import build_map, fusion, load, quality, read, reduction_rate

from .measure import SHARED, Row, missing, once, reference, seconds, workloads

N = 3604


def rows() -> Iterator[Row]:
    yield from real_maps()
    made = workloads()
    if made is None:
        yield from missing("redundant maps")
        return
    for seen in (20, 3):
        segments = redundant(made, N, seen)
        found = fusion(segments)
        what = f"n = {N}, each wall seen {seen} times"
        yield Row(
            f"fusion, {what}",
            f"{1e3 * seconds(lambda s=segments: fusion(s)):.1f} ms -> {len(found)}",
            "<= 50 ms",
        )
        after = segments[np.random.default_rng(0).permutation(N)[:700]]
        yield Row(
            f"quality against 700, {what}",
            f"{1e3 * seconds(lambda s=segments, a=after: quality(s, a)):.1f} ms",
            "<= 100 ms",
        )
    yield from against_literal(made)
    yield from growth(made)


def redundant(made, n: int, seen: int) -> np.ndarray:
    return made.redundant_segments(n, seen=seen)[0].reshape(-1, 2, 2)


def real_maps() -> Iterator[Row]:
    logs = [load("malaga")]
    path = SHARED / "data" / "intel.log.gz"
    if path.exists():
        intel = read(path)
        logs += [intel[::4], intel]
    for log in logs:
        map = build_map(log, log.truth)
        found = fusion(map)
        used = len(np.unique(map.scan))
        yield Row(
            f"fusion at 40 mm, {log.name}, {used} scans",
            f"{len(map)} -> {len(found)}, reduction {reduction_rate(map, found):.4f}, "
            f"quality {quality(map, found):.4f}, {1e3 * seconds(lambda m=map: fusion(m)):.1f} ms",
        )


def against_literal(made) -> Iterator[Row]:
    """The same work by the literal forms, at full size, once each."""
    slow = reference()
    for seen in (20, 3):
        segments = redundant(made, N, seen)
        after = segments[np.random.default_rng(0).permutation(N)[:700]]
        what = f"n = {N}, seen {seen}"
        a = once(lambda s=segments: slow.fusion(s.tolist(), 0.04))
        b = seconds(lambda s=segments: fusion(s))
        yield Row(f"fusion, literal / ours, {what}", f"{a:.1f} s / {1e3 * b:.1f} ms = {a / b:.0f}")
        a = once(lambda s=segments, f=after: slow.quality(s.tolist(), f.tolist()))
        b = seconds(lambda s=segments, f=after: quality(s, f))
        yield Row(f"quality, literal / ours, {what}", f"{a:.1f} s / {1e3 * b:.1f} ms = {a / b:.0f}")


def growth(made) -> Iterator[Row]:
    sizes = (1_000, 10_000, 100_000)
    for seen in (20, 3):
        took = [seconds(lambda s=redundant(made, n, seen): fusion(s), 3) for n in sizes]
        power = np.polyfit(np.log(sizes), np.log(took), 1)[0]
        figures = ", ".join(f"{t:.4f} s" for t in took)
        yield Row(
            f"fusion, n = 1e3, 1e4, 1e5, seen {seen}", f"{figures}: time ~ n^{power:.2f}", "~ n^1.2"
        )
