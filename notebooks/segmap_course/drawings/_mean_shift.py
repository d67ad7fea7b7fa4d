"""Drawings of the chapter on mean shift: a hill of pieces, centres that climb, two kernels."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from segmap import arrays
from segmap.arrays import Array, Segments
from segmap.plotting import DPI, ERROR, MAP, RAW, RESULT, TRUTH, axes_or_new, draw_segments

#: A centre is drawn as a dash of this length, in its direction.
DASH_M = 0.12


def draw_hill(places: ArrayLike, way: ArrayLike, sigma: float, *, ax: Axes | None = None) -> Axes:
    """Draw the density of pieces along y, black, and the way of a centre on it, orange.

    Places are those of the pieces, and the way is where the centre stands after each step, metres.
    """
    pieces, steps = np.asarray(places, float), np.asarray(way, float)
    margin = 2 * sigma

    def density(at: Array) -> Array:
        return np.asarray(np.exp(-(((at[:, None] - pieces) / sigma) ** 2) / 2).sum(axis=1))

    y = np.linspace(min(pieces.min(), steps.min()) - margin, pieces.max() + margin, 200)
    ax = axes_or_new(ax, (6.0, 3.5))
    ax.plot(y, density(y), color=MAP, label="density")
    ax.plot(pieces, 0 * pieces, "|", color=MAP, markersize=12, label="pieces")
    ax.plot(steps, density(steps), "o", color=ERROR, label="a centre, step by step")
    ax.set(title="Each step goes uphill", xlabel="y [m]", ylabel="sum of the weights")
    ax.legend(fontsize="small")
    return ax


def climb_frames(pieces: Segments, states: Sequence[ArrayLike]) -> Iterator[Figure]:
    """Figures of centres that climb, for a film: pieces grey, centres blue.

    A state `(n, 3)` holds x, y and angle of each centre, which is a dash in its direction.
    """
    array = arrays.segments(pieces)
    for state in states:
        x, y, turn = np.asarray(state, float).T
        half = DASH_M / 2 * np.stack([np.cos(turn), np.sin(turn)], axis=1)
        middle = np.stack([x, y], axis=1)
        ax = draw_segments(array, ax=axes_or_new(None, (4.4, 5.0)), color=RAW, width=1.0)
        draw_segments(np.stack([middle - half, middle + half], 1), ax=ax, color=RESULT, width=2.0)
        figure = ax.get_figure(root=True)
        assert figure is not None
        yield figure


def draw_phases(centres: ArrayLike, pieces: Segments, lines: Segments, sigma: float) -> list[Axes]:
    """Draw where centres of upright pieces rest after phase 1, and the lines of phase 2, blue.

    Dashed and green are the places where the weight of a piece has fallen to exp(-1/2) for the mean
    of the centres. The figure is new.

    Examples
    --------
    >>> wall = np.array([[(0, 0), (0, 0.2)], [(0.1, 0), (0.1, 0.2)]])
    >>> [ax.get_title() for ax in draw_phases([(0.05, 0.1, 1.57)], wall, wall, 0.2)]
    ['Phase 1: a round kernel', 'Phase 2: a thin one']
    """
    figure = plt.figure(figsize=(9.0, 4.2), dpi=DPI, layout="constrained")
    first, second = figure.subplots(1, 2, sharex=True, sharey=True)
    array, around = arrays.segments(pieces), np.linspace(0, 2 * np.pi, 60)
    x, y = np.mean(np.asarray(centres, float)[:, :2], axis=0)
    radii = {first: (sigma, sigma), second: np.sqrt(2) * np.array([sigma / 10, 2 * sigma])}
    for ax, (across, along) in radii.items():
        draw_segments(array, ax=ax, color=MAP, width=1.0)
        ax.plot(x + across * np.cos(around), y + along * np.sin(around), "--", color=TRUTH)
        ax.set(xlim=(x - 0.4, x + 0.4), ylim=(y - 0.7, y + 0.7))
        ax.label_outer()
    first.plot(*np.asarray(centres, float)[:, :2].T, "o", color=RESULT, markersize=4)
    draw_segments(lines, ax=second, color=RESULT, width=4.0)
    first.set_title("Phase 1: a round kernel")
    second.set_title("Phase 2: a thin one")
    return [first, second]
