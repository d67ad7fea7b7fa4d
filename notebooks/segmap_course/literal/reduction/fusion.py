"""Fusion (A 4.4), with every shift of the strip tried at every step."""

from __future__ import annotations

from collections.abc import Sequence

from ..lines import SAME, Segment, segment_length

#: Lowest and highest coordinate of a segment along a line, or across it, metres.
Interval = Sequence[float]


def chain(u: Sequence[Interval], held: Sequence[int], first: int) -> list[int]:
    """Those of the held segments whose projections u overlap one after another from the first."""
    found, todo = {first}, [first]
    while todo:
        a = todo.pop()
        new = [b for b in held if u[b][0] <= u[a][1] + SAME and u[a][0] <= u[b][1] + SAME]
        todo += set(new) - found
        found |= set(new)
    return sorted(found)


def best_strip(
    u: Sequence[Interval],
    v: Sequence[Interval],
    lengths: Sequence[float],
    first: int,
    tolerance: float,
) -> tuple[float, list[int]]:
    """The sweep: the shift of the line of the first segment whose strip has the longest chain.

    Only where a segment enters or leaves the strip can the chain change, so it is enough to try
    these shifts, and 0. Of equal chains the one of the smallest shift, then of the first indices.
    """
    borders = [t for low, high in v for t in (high - tolerance, low + tolerance)]
    strips = []
    for t in [0.0, *(t for t in borders if abs(t) <= tolerance + SAME)]:
        held = [
            i
            for i, (low, high) in enumerate(v)
            if high - tolerance <= t + SAME and t - SAME <= low + tolerance
        ]
        members = chain(u, held, first)
        strips.append((sum(lengths[i] for i in members), t, members))
    most = max(total for total, _, _ in strips)
    strips = [strip for strip in strips if strip[0] >= most - SAME]
    least = min(abs(t) for _, t, _ in strips)
    _, t, members = min((s for s in strips if abs(s[1]) <= least + SAME), key=lambda s: s[2])
    return t, members


def fusion(
    segments: Sequence[Segment], *, tolerance: float = 0.04
) -> tuple[list[Segment], list[int]]:
    """While the map is not empty, put one segment in the place of the best chain of the longest."""
    lengths = [segment_length(s) for s in segments]
    live = [i for i in range(len(segments)) if lengths[i] >= SAME]
    out: list[Segment] = []
    parents = [-1] * len(segments)
    while live:
        # A 4.4.4, step 1: the longest segment
        longest = max(lengths[i] for i in live)
        first = next(k for k, i in enumerate(live) if lengths[i] >= longest - SAME)
        (ax, ay), (bx, by) = segments[live[first]]
        x, y, size = (ax + bx) / 2, (ay + by) / 2, lengths[live[first]]
        dx, dy = (bx - ax) / size, (by - ay) / size
        # steps 2 to 5: the strip, parallel to it, with the longest chain
        u = [sorted((p[0] - x) * dx + (p[1] - y) * dy for p in segments[i]) for i in live]
        v = [sorted((p[1] - y) * dx - (p[0] - x) * dy for p in segments[i]) for i in live]
        t, members = best_strip(u, v, [lengths[i] for i in live], first, tolerance)
        # step 6: one segment for the chain
        x, y = x - t * dy, y + t * dx
        ends = min(u[k][0] for k in members), max(u[k][1] for k in members)
        for k in members:
            parents[live[k]] = len(out)
        out.append([(x + w * dx, y + w * dy) for w in ends])
        live = [i for k, i in enumerate(live) if k not in members]
    return out, parents
