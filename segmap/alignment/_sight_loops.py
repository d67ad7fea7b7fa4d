"""What walls hide from where: plain Python, compiled when called."""

import numpy as np

from .._compiled import compiled
from ..arrays import Array

#: Points of each segment, from one end to the other, that are looked at from a viewpoint.
LOOKS = np.array((0.1, 0.3, 0.5, 0.7, 0.9))


@compiled
def _is_hidden(px: float, py: float, x: float, y: float, walls: Array, margin: float) -> bool:
    """Whether a wall stands between (px, py) and (x, y), clear of both and not by its end only.

    Walls `(n, 2, 2)`, metres; one whose line passes within `margin` metres of (x, y) hides nothing.
    """
    reach = np.hypot(x - px, y - py)
    if reach <= margin:
        return False
    dx, dy = (x - px) / reach, (y - py) / reach
    for w in walls:
        a = dx * (w[0, 1] - py) - dy * (w[0, 0] - px)
        b = dx * (w[1, 1] - py) - dy * (w[1, 0] - px)
        if a * b >= 0:
            continue
        wx, wy = w[1, 0] - w[0, 0], w[1, 1] - w[0, 1]
        length, part = np.hypot(wx, wy), a / (a - b)
        ahead = dx * (w[0, 0] + part * wx - px) + dy * (w[0, 1] + part * wy - py)
        off = abs((x - w[0, 0]) * wy - (y - w[0, 1]) * wx) / length
        if (
            margin / 3 < ahead < reach
            and off > margin
            and min(part, 1 - part) * length > margin / 3
        ):
            return True
    return False


@compiled
def hidden(px: float, py: float, s: Array, walls: Array, margin: float, most: float) -> float:
    """Length of segments, metres, that walls hide from (px, py); it stops counting above `most`.

    Segments `(n, 2, 2)` and walls `(m, 2, 2)`, metres, in one frame.
    """
    lost = 0.0
    for i in range(len(s)):
        part = np.hypot(s[i, 1, 0] - s[i, 0, 0], s[i, 1, 1] - s[i, 0, 1]) / len(LOOKS)
        for t in LOOKS:
            x = s[i, 0, 0] + t * (s[i, 1, 0] - s[i, 0, 0])
            y = s[i, 0, 1] + t * (s[i, 1, 1] - s[i, 0, 1])
            if _is_hidden(px, py, x, y, walls, margin):
                lost += part
        if lost > most:
            return lost
    return lost


@compiled
def least_hidden(places: Array, s: Array, walls: Array, margin: float) -> float:
    """Length of segments, metres, that walls hide from the best of some places `(k, 2)`.

    Segments `(n, 2, 2)` and walls `(m, 2, 2)`, all in one frame, metres.
    """
    least = np.inf
    for p in places:
        least = min(least, hidden(p[0], p[1], s, walls, margin, least))
    return least
