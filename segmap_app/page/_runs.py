"""All runs: a row for each method of each one, in a table whose rows bring a run back."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import ipywidgets as W

from segmap.arrays import LIMIT

from ..pipeline import Pipeline
from . import _shown

#: What is kept of a run, and of which type it is.
COLUMNS: dict[str, type] = {
    **{"map": str, "alignment": str, "align_thresholds": str, "align_seconds": float},
    **{"extraction": str, "extract_thresholds": str, "filtered": float, "verdict": str},
    **{"placed": float, "method": str, "thresholds": str, "n_before": int, "n_after": int},
    **{"reduction": float, "quality": float, "seconds": float},
}


class Runs:
    """Rows of all runs, and the outcomes of the latest, by their rows."""

    def __init__(self) -> None:
        self.rows: list[dict[str, Any]] = []
        self.made: dict[int, Pipeline] = {}
        self.listed = W.HTML(layout=W.Layout(width="100%", overflow="auto"))

    def take(self, rows: Sequence[Mapping[str, Any]]) -> int:
        """Those of a session in the place of the others; how many were no rows of a run."""
        known = [{name: row.get(name) for name in COLUMNS} for row in rows]
        self.rows, self.made = [row for row in known if _is_run(row)], {}
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

    def _show(self) -> None:
        self.listed.value = _shown.runs_table(self.rows, self.made)


def _is_run(row: Mapping[str, object]) -> bool:
    """Whether all values of a row have the type of their column; whole numbers are numbers too."""
    kinds = {int: (int,), float: (int, float), str: (str,)}
    for name, kind in COLUMNS.items():
        value = row[name]
        if type(value) not in kinds[kind]:
            return False
        if isinstance(value, int | float) and not abs(value) < LIMIT:
            return False
    return True
