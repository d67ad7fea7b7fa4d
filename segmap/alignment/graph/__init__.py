"""Pose graphs: measured motions between poses, and the poses that fit all of them best."""

from ._bend import MOST_BEND, Bends, bends, chain_bends
from ._graph import (
    REAL,
    REAL_ERRORS,
    Graph,
    Rejected,
    deviations,
    groups,
    information,
    loops_of,
    place_deviations,
    residuals,
    solve_graph,
)
from ._solver import SCALE, Solver, solve
from ._solver_kernels import Edge, stack

__all__ = [
    "MOST_BEND", "REAL", "REAL_ERRORS", "SCALE", "Bends", "Edge", "Graph", "Rejected",
    "Solver", "bends", "chain_bends", "deviations", "groups", "information", "loops_of",
    "place_deviations", "residuals", "solve", "solve_graph", "stack",
]  # fmt: skip
