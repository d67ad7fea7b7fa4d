"""What the workbench says: a log in words, the figures of a run, all runs as points."""

from __future__ import annotations

import html
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from ..._display import facts
from ...alignment import Verdict
from ...metrics import grade_quality, grade_reduction, reduction_rate
from ...plotting import DPI, MAP, RAW, RESULT, draw_segments, figure_png, map_axes, method_style
from ...scans import Log
from ...segments import SegmentMap
from ._recipe import Outcome

#: Pixels of the static picture, and of the plane of quality and reduction.
WIDTH, HEIGHT, SIDE = 648, 320, 260
#: Colours of the verdicts, which colour-blind eyes tell apart too.
COLORS = {"good": "#009e73", "doubtful": "#e69f00", "not a map": "#d55e00"}
#: So many runs are listed.
LATEST = 8
CELL = 'style="padding: 1px 7px; text-align: left; white-space: nowrap"'
#: A widget sets lines far apart.
LINES = '<div style="line-height: 1.45; overflow-x: auto">'


def about(log: Log) -> str:
    """What a log is, in one paragraph of HTML."""
    named = [(log.name if word == "scans" else word, text) for word, text in facts(log)]
    lines = (f"<b>{html.escape(word)}</b> {html.escape(text)}" for word, text in named)
    return f"{LINES}{'<br>'.join(lines)}</div>"


def titles(outcome: Outcome) -> list[str]:
    """A title for each picture: the map before, and what each method leaves."""
    after = [f"{call.name}: {len(reduced)}" for call, reduced, _ in outcome.found()]
    return [f"before: {len(outcome.map)} segments", *after]


def verdict_line(verdict: Verdict) -> str:
    """The verdict on the map in its words, beside a stripe in the colour of its grade, as HTML."""
    stripe = f"border-left: 12px solid {COLORS[verdict.grade]}; padding: 3px 9px"
    return f'<div style="{stripe}"><b>{html.escape(verdict.words)}</b></div>'


def figures_table(outcome: Outcome) -> str:
    """Reduction, quality, A's words for both, and seconds, of each method, as HTML."""
    head = ["method", "segments", "reduction", "quality of the reduction", "seconds"]
    rows = []
    for call, reduced, kept in outcome.found():
        rate = reduction_rate(outcome.map, reduced)
        rows.append([
            f"{call.name} ({call.words()})",
            f"{len(outcome.map)} to {len(reduced)}",
            f"{rate:.1%}, {grade_reduction(rate)}",
            f"{kept:.1%}, {grade_quality(kept)}",
            f"{reduced.seconds:.3f}",
        ])  # fmt: skip
    notes = [outcome.alignment.doubt, *(each.doubt for each in outcome.reductions)]
    doubts = "".join(f"<br>{html.escape(note)}" for note in notes if note)
    used, count = int(outcome.alignment.used.sum()), len(outcome.alignment)
    name, seconds = outcome.recipe.align.name, outcome.alignment.seconds
    way = f"{name}: {used} of {count} scans placed, {seconds:.3f} s"
    return f"{_table(head, rows)}{LINES}{html.escape(way)}{doubts}</div>"


def runs_table(rows: Sequence[dict[str, Any]]) -> str:
    """The latest runs, as HTML, the last one first."""
    head = ["run", "log", "alignment", "method", "thresholds", "left", "reduction", "quality"]
    latest = list(enumerate(rows))[::-1][:LATEST]
    return _table(head, [
        [k, r["map"], r["alignment"], r["method"], r["thresholds"],
         f"{r['n_after']} of {r['n_before']}", f"{r['reduction']:.1%}", f"{r['quality']:.1%}"]
        for k, r in latest
    ])  # fmt: skip


def _table(head: Iterable[object], rows: Iterable[Iterable[object]]) -> str:
    first = "".join(f"<th {CELL}>{html.escape(str(cell))}</th>" for cell in head)
    others = "".join(
        "<tr>" + "".join(f"<td {CELL}>{html.escape(str(cell))}</td>" for cell in row) + "</tr>"
        for row in rows
    )
    return f"{LINES}<table><tr>{first}</tr>{others}</table></div>"


def plane(rows: Sequence[dict[str, Any]]) -> str:
    """All runs as points of quality and reduction, as SVG; the newest has a ring."""
    names = list(dict.fromkeys(row["method"] for row in rows))
    color = {name: method_style(name, k)[0] for k, name in enumerate(names)}
    ticks = "".join(
        f'<path d="M{_x(t)} {_y(0)}V{_y(1)}M{_x(0)} {_y(t)}H{_x(1)}" stroke="#e0e0e0"/>'
        f'<text x="{_x(t)}" y="{_y(0) + 15}" text-anchor="middle">{t:.0%}</text>'
        f'<text x="{_x(0) - 4}" y="{_y(t) + 4}" text-anchor="end">{t:.0%}</text>'
        for t in (0, 0.25, 0.5, 0.75, 1)
    )
    dots = "".join(_dot(k, row, color[row["method"]], len(rows)) for k, row in enumerate(rows))
    legend = "".join(
        f'<circle cx="{SIDE + 12}" cy="{26 + 18 * k}" r="5" fill="{color[name]}"/>'
        f'<text x="{SIDE + 22}" y="{30 + 18 * k}">{html.escape(name)}</text>'
        for k, name in enumerate(names)
    )
    words = (
        f'<text x="{_x(0.5)}" y="{SIDE + 14}" text-anchor="middle">quality</text>'
        f'<text transform="translate(11 {_y(0.5)}) rotate(-90)" text-anchor="middle">'
        "reduction</text>"
    )
    size = f'width="{SIDE + 170}" height="{SIDE + 20}" style="max-width: 100%"'
    box = f'viewBox="0 0 {SIDE + 170} {SIDE + 20}" font-size="12" font-family="sans-serif"'
    return f"<svg {size} {box}>{ticks}{words}{dots}{legend}</svg>"


def _dot(k: int, row: dict[str, Any], color: str, count: int) -> str:
    x, y = _x(row["quality"]), _y(row["reduction"])
    told = html.escape(f"run {k}: {row['method']}({row['thresholds']}) on {row['map']}")
    ring = f'<circle cx="{x}" cy="{y}" r="8" fill="none" stroke="#d55e00" stroke-width="2"/>'
    dot = f'<circle cx="{x}" cy="{y}" r="5" fill="{color}"><title>{told}</title></circle>'
    return dot + (ring if k == count - 1 else "")


def _x(share: float) -> float:
    return round(48 + (SIDE - 62) * (share if np.isfinite(share) else 0.0), 1)


def _y(share: float) -> float:
    return round(SIDE - 18 - (SIDE - 28) * max(0.0, share), 1)


def still(outcome: Outcome) -> bytes:
    """The picture for readers without a kernel: the map, and beside it what is left, over it."""
    figure = Figure((WIDTH / DPI, HEIGHT / DPI), dpi=DPI, layout="constrained")
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
