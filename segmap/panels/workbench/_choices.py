"""All that can be chosen on the workbench between a log and a reduced map."""

from __future__ import annotations

from typing import Any

import ipywidgets as W

from ... import alignment, reduction
from ._controls import ENTRY, Choice
from ._recipe import EXTRACTIONS, Recipe

#: What the list of second methods says of none.
NONE = "none"


class Choices:
    """Alignment, extraction, filter, method and a second method.

    Attributes
    ----------
    align, extract, method, second : Choice
    least : number, metres
    """

    def __init__(self) -> None:
        alignments = {k: (m.function, "") for k, m in alignment.METHODS.items()}
        reductions = {k: (m.function, m.varies) for k, m in reduction.METHODS.items()}
        extractions = {k: (f, "") for k, f in EXTRACTIONS.items()}
        self.align = Choice("alignment", alignments, "pose_graph")
        self.extract = Choice("extraction", extractions, "extract_polylines")
        self.method = Choice("method", reductions, "fusion")
        self.second = Choice("second method", {NONE: None, **reductions}, NONE)
        named: Any = {"description": "leave out below [m]", "style": ENTRY}
        self.least: Any = W.BoundedFloatText(0.0, min=0, max=100, step=0.05, **named)
        self.least.layout.width = "220px"

    def recipe(self, log: str) -> Recipe:
        """All that is chosen, for the log that an expression gives.

        Raises
        ------
        ValueError
            Where a threshold is no number.
        """
        chosen = (choice.call() for choice in (self.align, self.extract, self.method))
        align, extract, first = (call for call in chosen if call is not None)
        return Recipe(log, align, extract, float(self.least.value), first, self.second.call())

    def views(self) -> dict[str, Any]:
        """Their controls, by the titles of their tabs."""
        return {
            "Alignment": self.align.view,
            "Segments": W.VBox([self.extract.view, self.least]),
            "Reduction": self.method.view,
            "Second": self.second.view,
        }
