"""What the workbench says: a log in words, each step of a run, all runs in a table."""

from __future__ import annotations

from collections.abc import Container, Iterable, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from segmap.alignment import Verdict
from segmap.display import facts
from segmap.files import as_html
from segmap.metrics import grade_quality, grade_reduction, reduction_rate
from segmap.plotting import DPI, MAP, RAW, RESULT, draw_segments, figure_png, map_axes
from segmap.scans import Log
from segmap.segments import SegmentMap

from ..pipeline import Pipeline

#: Width of the static picture, pixels.
STATIC_WIDTH = 648
#: Its height, pixels.
STATIC_HEIGHT = 320
#: Colours of the verdicts, which colour-blind eyes tell apart too.
COLORS = {
    "good": "#009e73",
    "not checked": "#56728f",
    "doubtful": "#c47f00",
    "not a map": "#d55e00",
}
#: So many runs are listed.
LATEST = 8
#: A widget sets lines far apart; a table that is too wide has a bar of its own to move it.
LINES = '<div style="line-height: 1.45; overflow-x: auto; max-width: 100%">'
CODE = "font-family: monospace; line-height: 1.4; white-space: pre; overflow-x: auto; padding: 8px"
#: A button that canvas.js listens to: it copies what stands before it.
COPY = '<button class="jupyter-button segmap-copy">Copy</button>'
#: Buttons that bring a run back, or show its map beside the one that is seen.
AGAIN = '<button class="jupyter-button segmap-run" data-run="{0}" data-way="{1}">show {1}</button>'
WAYS = ("again", "beside")


def heading(text: str) -> str:
    """A heading of the page, as HTML."""
    return f'<h2 style="font-size: 15px; margin: 6px 0 2px">{as_html(text)}</h2>'


def advice(words: str) -> str:
    """What to do with the laser, large, as HTML."""
    return f'<div role="alert">{as_html(words)}</div>' * bool(words)


def about_html(log: Log) -> str:
    """What a log is, in one paragraph of HTML."""
    named = [(log.name if word == "scans" else word, text) for word, text, _ in facts(log)]
    lines = (f"<b>{as_html(word)}</b> {as_html(text)}" for word, text in named)
    return f"{LINES}{'<br>'.join(lines)}</div>"


def done(outcome: Pipeline) -> str:
    """That a run is done, or how far it came until it was stopped."""
    return f"{outcome.given.name}: " + (
        f"{outcome.stopped}; Run maps all of it" if outcome.stopped else "done"
    )


def titles(outcome: Pipeline) -> list[str]:
    """A title for each picture: the map before, and what each method leaves."""
    after = [f"{call.name}: {len(reduced)}" for call, reduced, _ in outcome.results()]
    return [f"before: {len(outcome.map)} segments", *after]


def summary(outcome: Pipeline, size: Sequence[float]) -> str:
    """What the picture shows, in words for who does not see it."""
    wide, high = size
    return f"{outcome.verdict.words}. {outcome.summary()}. {wide:.1f} m wide, {high:.1f} m high."


def verdict_line(verdict: Verdict) -> str:
    """The verdict on the map in its words, beside a stripe in the colour of its grade, as HTML."""
    stripe = f"border-left: 12px solid {COLORS[verdict.grade]}; padding: 3px 9px; line-height: 1.45"
    return f'<div style="{stripe}"><b>{as_html(verdict.words)}</b></div>'


def verdict_html(outcome: Pipeline) -> str:
    """The verdict on the map, what to doubt of it, and the time that the poses took, as HTML."""
    way = f"{outcome.recipe.align.name}, {outcome.alignment.seconds:.1f} s"
    return verdict_line(outcome.verdict) + _lines([outcome.alignment.doubt, way])


def by_method(outcome: Pipeline) -> str:
    """What each method leaves, in A's words for reduction and quality, as HTML."""
    lines = []
    for call, reduced, quality in outcome.results():
        rate = reduction_rate(outcome.map, reduced)
        lines += [
            f"{call.name} ({call.words()}): {len(reduced)} of {len(outcome.map)} segments left, "
            f"reduction {rate:.1%}, {grade_reduction(rate)}; "
            f"quality {quality:.1%}, {grade_quality(quality)}; {reduced.seconds:.3f} s",
            reduced.doubt,
        ]
    return _lines(lines)


def _lines(said: Iterable[str]) -> str:
    return LINES + "<br>".join(as_html(text) for text in said if text) + "</div>"


def code(text: str) -> str:
    """Python to be copied, as HTML."""
    return f'<pre style="{CODE}">{as_html(text)}</pre>{COPY}'


def runs_table(rows: Sequence[dict[str, Any]], kept: Container[int] = ()) -> str:
    """The latest runs, the last one first, as HTML: a bar in each cell of reduction and quality.

    Those that are kept have buttons, to which canvas.js listens, that show them again.
    """
    head = ["run", "method", "thresholds", "left", "of", "seconds", "log", "alignment"]
    columns = ["method", "thresholds", "n_after", "n_before", "seconds", "map", "alignment"]
    first = "".join(f"<th>{word}</th>" for word in ["reduction", "quality", *head])
    body = ""
    for k, row in list(enumerate(rows))[::-1][:LATEST]:
        cells = "".join(_cell(value) for value in (k, *(row[name] for name in columns)))
        cells += f"<td>{''.join(AGAIN.format(k, way) for way in WAYS)}</td>" * (k in kept)
        body += f"<tr>{_bar(row['reduction'])}{_bar(row['quality'])}{cells}</tr>"
    return f"{LINES}<table style='border-spacing: 8px 2px'><tr>{first}</tr>{body}</table></div>"


def _cell(value: object) -> str:
    """A cell; numbers stand at the right."""
    if isinstance(value, int | float):
        text = f"{value:.3f}" if isinstance(value, float) else str(value)
        return f'<td style="text-align: right">{text}</td>'
    return f"<td>{as_html(value)}</td>"


def _bar(share: float) -> str:
    """A cell with a share, and a bar as long."""
    full = 100 * min(max(share, 0.0), 1.0) if np.isfinite(share) else 0.0
    back = f"linear-gradient(90deg, #bfdcec {full:.1f}%, #f0f0f0 {full:.1f}%)"
    style = f"text-align: right; min-width: 90px; color: black; background: {back}"
    return f'<td style="{style}">{share:.1%}</td>'


def still(outcome: Pipeline) -> bytes:
    """The picture for readers without a kernel: the map, and beside it what is left, over it."""
    figure = Figure((STATIC_WIDTH / DPI, STATIC_HEIGHT / DPI), dpi=DPI, layout="constrained")
    count = 1 + len(outcome.reductions)
    first, *others = figure.subplots(1, count, sharex=True, sharey=True)
    draw_segments(outcome.map, ax=first, color=MAP, width=0.7)
    for ax, reduced in zip(others, outcome.reductions, strict=True):
        draw_segments(SegmentMap(outcome.map.segments), ax=ax, color=RAW, width=0.7)
        draw_segments(reduced, ax=ax, color=RESULT, width=1.5)
    for ax, title in zip((first, *others), titles(outcome), strict=True):
        map_axes(ax).set_title(title, fontsize="medium")
        ax.label_outer()
    return figure_png(figure)
