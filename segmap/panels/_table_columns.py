"""The first rows of a table, with a choice above each column of what it is."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import ipywidgets as W

from ..files import as_html

#: What a column may be; "-" is left out.
COLUMN_KINDS = (
    *("-", "angle_deg", "angle_rad", "range_mm", "range_cm", "range_m", "range_ft", "range_in"),
    *("time_s", "time_ms", "time_us", "time_ns", "scan", "new", "x_m", "y_m", "x_mm", "y_mm"),
)
#: Tables of more columns are none with a line a beam.
MOST_COLUMNS = 12
#: Width of a column.
COLUMN_WIDTH = "112px"


class TableColumns:
    """Names columns of a table: `chosen` is called with them, and whether angles grow clockwise.

    Examples
    --------
    >>> table = TableColumns(lambda names, clockwise: print(names, clockwise))
    >>> table.show(["angle_deg", "-"], [["0", "1500"], ["90", "2000"]])
    >>> table.kinds[1].value = "range_mm"
    >>> table.read.click()
    ['angle_deg', 'range_mm'] False
    """

    def __init__(self, chosen: Callable[[list[str], bool], None]) -> None:
        self.kinds: list[Any] = []
        self.clockwise: Any = W.Checkbox(False, description="angles grow clockwise", indent=False)
        self.read: Any = W.Button(
            description="Read it so", tooltip="read the table by these columns"
        )
        self.view = W.VBox(layout=W.Layout(display="none", overflow="auto"))
        self.read.on_click(
            lambda button: chosen([kind.value for kind in self.kinds], self.clockwise.value)
        )

    def show(self, names: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
        """Show these rows below what the columns may be; nothing where there are none."""
        known = 2 <= len(names) <= MOST_COLUMNS and bool(rows)
        self.view.layout.display = "" if known else "none"
        if not known:
            self.kinds, self.view.children = [], ()
            return
        wide = W.Layout(width=COLUMN_WIDTH)
        self.kinds = [
            W.Dropdown(
                options=[*dict.fromkeys((*COLUMN_KINDS, name))],
                value=name,
                layout=wide,
                tooltip=f"what column {place} is",
            )
            for place, name in enumerate(names, 1)
        ]
        cells = [W.HTML(as_html(row[k][:14]), layout=wide) for row in rows for k in range(len(row))]
        grid = W.GridBox(
            [*self.kinds, *cells],
            layout=W.Layout(grid_template_columns=f"repeat({len(names)}, {COLUMN_WIDTH})"),
        )
        told = W.HTML("the first rows of the table, and what each column is taken for")
        self.view.children = (told, grid, W.HBox([self.read, self.clockwise]))
