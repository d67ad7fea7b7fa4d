"""Pose graphs: measured motions between poses, and the poses that fit all of them best."""

from ._graph import (
    SCALE,
    Edge,
    Graph,
    Rejected,
    deviations,
    information,
    residuals,
    solve_graph,
    stacked,
)
from ._solver import (
    Solver,
)
