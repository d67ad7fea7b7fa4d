"""How scans, maps and reductions show themselves in a notebook, and tables of a few words."""

from __future__ import annotations

import base64
import html
from collections.abc import Iterable
from functools import singledispatch
from typing import Any


class Pictured:
    """Gives an object its picture in a notebook, beside its `repr`.

    The picture comes from the function that is registered for its type in `picture`. Like every
    picture in a notebook file it is base64 text.
    """

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, Any]:
        png = base64.b64encode(picture(self)).decode("ascii")
        return {"text/plain": repr(self), "image/png": png}


@singledispatch
def picture(value: object) -> bytes:
    """A small PNG of an object.

    `segmap.plotting` registers a function for each type that it can draw; `segmap` registers one
    for all `Pictured` objects that first imports `segmap.plotting`. This room knows neither.
    """
    raise TypeError(f"no drawing is registered for {type(value).__name__}")


class Table:
    """Rows of words below a head: a table in a notebook, columns of text elsewhere.

    Parameters
    ----------
    head : iterable of str
    rows : iterable of iterables
        Of anything that has a `str`.

    Raises
    ------
    ValueError
        Where a row is not as long as the head.

    Examples
    --------
    >>> Table(["method", "left"], [["fusion", 266], ["hybrid", 391]])
    method  left
    fusion  266
    hybrid  391
    """

    def __init__(self, head: Iterable[str], rows: Iterable[Iterable[object]]) -> None:
        self.head = tuple(head)
        self.rows = tuple(tuple(str(cell) for cell in row) for row in rows)
        for row in self.rows:
            if len(row) != len(self.head):
                raise ValueError(f"rows must have {len(self.head)} cells, got {row}")

    def __repr__(self) -> str:
        widths = [max(map(len, column)) for column in zip(self.head, *self.rows, strict=True)]
        lines = (zip(row, widths, strict=True) for row in (self.head, *self.rows))
        return "\n".join("  ".join(c.ljust(w) for c, w in line).rstrip() for line in lines)

    def _repr_html_(self) -> str:
        rows = [_html_row("th", self.head), *(_html_row("td", row) for row in self.rows)]
        return f"<table>{''.join(rows)}</table>"


def _html_row(tag: str, cells: tuple[str, ...]) -> str:
    """Words to the left, numbers where notebooks put all: to the right."""
    left = ' style="text-align: left"'
    tags = (tag if cell[:1] in "+-0123456789" else tag + left for cell in cells)
    pairs = zip(tags, cells, strict=True)
    return f"<tr>{''.join(f'<{start}>{html.escape(c)}</{tag}>' for start, c in pairs)}</tr>"
