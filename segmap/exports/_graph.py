"""Pose graphs for other solvers."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .. import arrays
from ..alignment import Alignment
from ..arrays import Array
from ..files import write_lines
from ..poses import information


class PoseGraph(NamedTuple):
    """Poses and measured motions between them, as `alignment.solve_graph` takes them.

    Examples
    --------
    >>> graph = PoseGraph(np.zeros((2, 3)), [(0, 1)], [(1.0, 0.0, 0.0)], np.eye(3)[None])
    >>> graph.ids is None
    True
    """

    poses: Array  #: (n, 3), metres and radians
    edges: NDArray[np.int64]  #: (m, 2): rows of `poses` that are joined
    relative: Array  #: (m, 3): pose of the second in the frame of the first
    information: Array  #: (m, 3, 3): inverse covariance, in the frame of the first
    ids: NDArray[Any] | None = None  #: (n,): names of the vertices; None: their rows
    left_out: Mapping[str, int] = MappingProxyType({})  #: lines that do not concern the poses


def write_graph(path: str | Path, graph: Alignment | PoseGraph) -> None:
    """Write a pose graph for g2o, gtsam, Ceres: VERTEX_SE2 and EDGE_SE2 lines, and nothing else.

    All scans are vertices, named by their number. Those without an edge stay where they are: on a
    tracked log only key scans are solved for, and the others follow them. They have no measurement
    of their own that an edge could state. Other
    solvers minimise plain squares: their minimum is that of `alignment.solve_graph` with
    `scale=inf`, while `alignment.pose_graph` distrusts what fits badly. The file does not tell what
    was rejected, nor which edges are loops.

    An alignment needs a graph that weighs its edges, as `alignment.pose_graph` gives it.

    Notes
    -----
    g2o measures what is left of an edge in the frame where the motion ends, `solve_graph` in the
    frame where it begins: the information is turned on its way.

    Examples
    --------
    >>> import tempfile
    >>> graph = PoseGraph(np.zeros((2, 3)), [(0, 1)], [(1, 0, np.pi / 2)], [np.diag([1, 4, 9])])
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_graph(Path(folder) / "it.g2o", graph)
    ...     print((Path(folder) / "it.g2o").read_text().splitlines()[0])
    VERTEX_SE2 0 0.0 0.0 0.0
    """
    place, graph = arrays.file(path), _checked_graph(graph)
    if not (count := len(graph.poses)):
        raise ValueError("graph must hold at least one pose, got none")
    ids = np.arange(count) if graph.ids is None else arrays.indices(graph.ids, "graph.ids")
    if ids.shape != (count,) or ids.min() < 0 or len(np.unique(ids)) < count:
        raise ValueError(f"graph.ids must be {count} different numbers from 0, got {ids}")
    names = ids.tolist()
    lines = [
        f"VERTEX_SE2 {name} {_graph_row(pose)}"
        for name, pose in zip(names, graph.poses, strict=True)
    ]
    turned = information.rotate(graph.information, graph.relative[:, 2])
    upper = turned.reshape(-1, 9)[:, [0, 1, 2, 4, 5, 8]]
    for (i, j), motion, six in zip(graph.edges.tolist(), graph.relative, upper, strict=True):
        lines.append(f"EDGE_SE2 {names[i]} {names[j]} {_graph_row(motion)} {_graph_row(six)}")
    write_lines(place, lines)


def _checked_graph(graph: Alignment | PoseGraph) -> PoseGraph:
    """The arrays of a graph, each as it must be."""
    if isinstance(graph, Alignment):
        inner = graph.graph
        if inner is None or inner.information is None:
            raise ValueError(
                f"graph must be an alignment with a graph that weighs its edges, as "
                f"alignment.pose_graph gives it, got {graph!r}"
            )
        graph = PoseGraph(graph.poses, inner.edges, inner.relative, inner.information)
    if not isinstance(graph, PoseGraph):
        raise ValueError(f"graph must be an Alignment or a PoseGraph, got {arrays.brief(graph)}")
    poses = arrays.poses(graph.poses, "graph.poses")
    edges = arrays.table(graph.edges, "graph.edges", 2, unit="rows of poses")
    ends = arrays.indices(edges, "graph.edges")
    if len(ends) and not (ends.min() >= 0 and ends.max() < len(poses)):
        got = f"{ends.min()} to {ends.max()}"
        raise ValueError(f"graph.edges must name rows 0 to {len(poses) - 1} of poses, got {got}")
    relative = arrays.poses(graph.relative, "graph.relative", count=len(ends))
    weight = information.checked_information(graph.information, len(ends))
    return PoseGraph(poses, ends, relative, weight, graph.ids)


def _graph_row(values: Array) -> str:
    """Numbers with all their digits."""
    return " ".join(map(repr, values.tolist()))
