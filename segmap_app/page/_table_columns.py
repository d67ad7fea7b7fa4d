"""The first rows of a table, with a choice above each column of what it is."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import ipywidgets as W

from segmap.files import as_html
from segmap.readers import ColumnChoices

#: Tables of more columns are none with a line a beam.
MOST_SHOWN_COLUMNS = 12
#: Width of a column.
COLUMN_WIDTH = "128px"
MOST_CHARACTERS = 14


class TableColumns:
    """Names columns of a table: `chosen` is called with them, and the view of a scan a row.

    Examples
    --------
    >>> table = TableColumns(lambda names, view: print(names, view))
    >>> choices = (("angle_deg",), ("range_mm", "range_cm")), (("0", "1500"), ("90", "2000"))
    >>> table.show(ColumnChoices("the unit of 'range' is not said", *choices))
    >>> table.read.disabled
    True
    >>> table.kinds[1].value = "range_mm"
    >>> table.read.click()
    ['angle_deg', 'range_mm'] None
    """

    def __init__(self, chosen: Callable[[list[str], tuple[float, float] | None], None]) -> None:
        self._chosen, self.kinds = chosen, list[Any]()
        wide: Any = {"layout": W.Layout(width="220px"), "style": {"description_width": "initial"}}
        self.first: Any = W.Text(description="first range points to", placeholder="-90", **wide)
        self.last: Any = W.Text(description="last to, degrees", placeholder="90", **wide)
        self.read: Any = W.Button(
            description="Read it so", tooltip="read the table by these columns"
        )
        self.view = W.VBox(layout=W.Layout(display="none", overflow="auto"))
        self.read.on_click(lambda button: chosen(*self._named()))
        for end in (self.first, self.last):
            end.observe(self._changed, names="value")

    def _named(self) -> tuple[list[str], tuple[float, float] | None]:
        """The names that are chosen, and the view; a ValueError where it is no number."""
        is_wide = self.first.layout.display != "none"
        view = (float(self.first.value), float(self.last.value)) if is_wide else None
        return ",".join(kind.value for kind in self.kinds).split(","), view

    def _changed(self, change: object = None) -> None:
        try:
            names, _ = self._named()
        except ValueError:
            names = [""]
        self.read.disabled = "" in names

    def show(self, found: ColumnChoices | None = None) -> None:
        """Show the first rows below what the columns may be; nothing where there are none."""
        fits = found is not None and bool(found.rows) and len(found.choices) <= MOST_SHOWN_COLUMNS
        self.view.layout.display = "" if fits else "none"
        self.kinds = []
        if found is None or not fits:
            self.view.children = ()
            return
        cell = W.Layout(width=COLUMN_WIDTH)
        for place, names in enumerate(found.choices, 1):
            menu: Any = W.Combobox(
                options=[*dict.fromkeys((*names, "-", *found.every_name))],
                value="" if names[1:] else names[0],
                placeholder="choose, or write",
                description=f"what column {place} is",  # canvas.css hides it: for who hears it
                layout=cell,
            )
            menu.observe(self._changed, names="value")
            self.kinds.append(menu)
        count = len(self.kinds)
        cells = [
            W.HTML(as_html(field[:MOST_CHARACTERS]), layout=cell)
            for row in found.rows
            for field in (*row[:count], *[""] * (count - len(row)))
        ]
        columns = f"repeat({count}, {COLUMN_WIDTH})"
        grid = W.GridBox([*self.kinds, *cells], layout=W.Layout(grid_template_columns=columns))
        for end in (self.first, self.last):
            end.layout.display = "" if found.needs_view else "none"
        lines = found.missing or "what the table says of its columns", *found.words
        head = W.HTML("<br>".join(map(as_html, lines)))
        self.view.children = (head, grid, W.HBox([self.first, self.last, self.read]))
        self._changed()
