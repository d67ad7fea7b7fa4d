"""All runs: a row for each method of each one, in a table whose rows bring a run back."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import ipywidgets as W

from ..pipeline import Pipeline
from . import _shown

if TYPE_CHECKING:
    from pandas import DataFrame

#: What is kept of a run.
COLUMNS = (
    *("map", "alignment", "align_thresholds", "align_seconds", "extraction", "extract_thresholds"),
    *("filtered", "verdict", "placed", "method", "thresholds", "n_before", "n_after", "reduction"),
    *("quality", "seconds"),
)


class Runs:
    """Rows of all runs, and the outcomes of the latest, by their rows."""

    def __init__(self) -> None:
        self.rows: list[dict[str, Any]] = []
        self.made: dict[int, Pipeline] = {}
        self.listed = W.HTML(layout=W.Layout(width="100%", overflow="auto"))

    def take(self, rows: Sequence[Mapping[str, Any]]) -> int:
        """Those of a session in the place of the others; how many were no rows of a run."""
        self.rows = [{name: row[name] for name in COLUMNS} for row in rows if {*COLUMNS} <= {*row}]
        self.made = {}
        self._show()
        return len(rows) - len(self.rows)

    def add(self, outcome: Pipeline) -> None:
        """One more; a row that is known is not repeated."""
        for row in outcome.rows(outcome.given.name):
            if row not in self.rows:
                self.rows.append(row)
            self.made[self.rows.index(row)] = outcome
        self.made = dict(sorted(self.made.items())[-_shown.LATEST :])
        self._show()

    def frame(self) -> DataFrame:
        """The rows, as pandas has them."""
        import pandas as pd

        return pd.DataFrame(self.rows, columns=COLUMNS)

    def _show(self) -> None:
        self.listed.value = _shown.runs_table(self.rows, self.made)
