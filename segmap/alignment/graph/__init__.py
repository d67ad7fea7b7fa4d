"""Pose graphs: measured motions between poses, and the poses that fit all of them best."""

from ._equations import Edge, stacked
from ._graph import (
    REAL,
    REAL_ERRORS,
    Graph,
    Rejected,
    deviations,
    groups,
    information,
    loops_of,
    residuals,
    solve_graph,
)
from ._solver import SCALE, Solver, solve
from ._spread import NEARBY, place_deviations

__all__ = [
    "NEARBY", "REAL", "REAL_ERRORS", "SCALE", "Edge", "Graph", "Rejected", "Solver", "deviations",
    "groups", "information", "loops_of", "place_deviations", "residuals", "solve", "solve_graph",
    "stacked",
]  # fmt: skip
