"""Segment ICP (A 2.5.1; Amigoni, Fontana and Garigiola 2006): the cost 2.1 as a double loop."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ..lines import Segment, axial_difference, line_angle, segment_length
from ..metrics import segment_distance


def correspond(s: Segment, t: Segment, angle: float, distance: float) -> bool:
    """Whether two segments lie beside each other, within an angle and a segment distance."""
    at = line_angle(s)
    dx, dy = (t[0][k] + t[1][k] - s[0][k] - s[1][k] for k in (0, 1))  # twice from middle to middle
    beside = abs(dx * math.cos(at) + dy * math.sin(at)) < segment_length(s) + segment_length(t)
    turned = abs(axial_difference(at, line_angle(t)))
    return beside and turned < angle and segment_distance(s, t) < distance


def segment_cost(
    reference: Sequence[Segment], current: Sequence[Segment], angle: float, distance: float
) -> float:
    """A 2.1, metres, with the penalty inside its bracket: `(sum D' + N_n distance) / (N_m + N_n)`.

    D' is the mean distance of a segment from all that it corresponds to, weighted with their
    lengths; one that corresponds to none costs `distance`.
    """
    total = 0.0
    for s in current:
        matches = [t for t in reference if correspond(s, t, angle, distance)]
        weight = sum(segment_length(t) for t in matches)
        away = sum(segment_length(t) * segment_distance(s, t) for t in matches)
        total += away / weight if matches else distance
    return total / len(current)
