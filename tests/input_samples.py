"""Inputs that every function should meet before a user brings them."""

from __future__ import annotations

import numpy as np

from segmap.arrays import Array


def segment_samples() -> dict[str, Array]:
    """Maps of segments that have broken programs: empty, crossing, vertical, repeated, tiny, far.

    New arrays at each call. All are finite.
    """
    wall = [(0, 0), (2, 0)]
    samples = {
        "empty": [],
        "single": [wall],
        "vertical": [[(1, 0), (1, 2)]],
        "collinear, overlapping": [wall, [(1, 0), (3, 0)]],
        "collinear, touching": [wall, [(2, 0), (3, 0)]],
        "collinear, apart": [wall, [(5, 0), (6, 0)]],
        "crossing": [wall, [(1, -1), (1, 1)]],
        "corner": [wall, [(2, 0), (2, 2)]],
        "parallel, close": [wall, [(0, 0.02), (2, 0.02)]],
        "one and 179 degrees": [_ray(1.0), _ray(179.0)],
        "duplicate": [wall, wall, wall],
        "reversed": [wall, wall[::-1]],
        "without length": [[(1, 1), (1, 1)]],
        "with and without length": [wall, [(1, 0), (1, 0)], [(0, 1), (0, 1)]],
        "tiny": [[(0, 0), (1e-7, 0)], [(0, 1e-7), (1e-7, 1e-7)]],
        "contained": [wall, [(0.5, 0), (1, 0)]],
    }
    arrays = {name: np.array(list_, float).reshape(-1, 2, 2) for name, list_ in samples.items()}
    return {
        **arrays,
        "far away": arrays["crossing"] + 1e6,
        "lattice": _lattice(),
        "walls": _walls(),
    }


def _ray(degrees: float) -> list[tuple[float, float]]:
    angle = np.radians(degrees)
    return [(0.0, 0.0), (2 * float(np.cos(angle)), 2 * float(np.sin(angle)))]


def _lattice() -> Array:
    """Walls of equal length at equal distances: every choice of a nearest or longest is a tie."""
    cells = [(float(x), float(y)) for x in range(3) for y in range(3)]
    across = [[(x, y), (x + 1, y)] for x, y in cells]
    return np.array([*across, *([(x, y), (x, y + 1)] for x, y in cells)])


def _walls() -> Array:
    """Four walls, each seen twenty times by a sensor with noise."""
    rng = np.random.default_rng(1)
    room = np.array([[(0, 0), (4, 0)], [(4, 0), (4, 3)], [(4, 3), (0, 3)], [(0, 3), (0, 0)]])
    return np.tile(room, (20, 1, 1)) + rng.normal(0, 0.01, (80, 2, 2))


def text_samples() -> list[str]:
    """Names and words from outside that have run code, moved a cursor, or led to other folders."""
    code = "window.hit=1"
    return [
        f"<script>{code}</script>",
        f"<img src=x onerror={code}>",
        f'"><svg onload={code}>',
        f"' onmouseover='{code}' x='",
        f"</pre></div><button onclick={code}>Run</button>",
        f"&lt;img src=x onerror={code}&gt;",
        f"<a href=javascript:{code}>here</a> {{{{7*7}}}} $\\frac{{",
        "\x1b[2J\x1b]8;;http://evil.example\x07 \u202egol.a\x00",
        "../../../up",
    ]


def value_samples() -> list[object]:
    """The same as JSON may hold it where a number or a word should stand, and no numbers."""
    texts = text_samples()
    inside = [[texts[0]], {texts[1]: texts[1]}, {texts[2]: [texts[2]]}]
    return [*texts[:3], *inside, [inside], True, None, 10**400, 1e999, -1e300, [], {}]
