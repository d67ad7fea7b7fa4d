"""Pose graphs for other solvers."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .. import arrays
from ..alignment import Alignment
from ..arrays import Array
from ..files import write_lines
from ..poses import information
from ..readers import PoseGraph


def write_graph(path: str | Path, graph: Alignment | PoseGraph) -> None:
    """Write a pose graph for g2o, gtsam, Ceres: VERTEX_SE2 and EDGE_SE2 lines, and nothing else.

    All scans are vertices, named by their number; those without an edge stay where they are. Other
    solvers minimise plain squares: their minimum is that of `alignment.solve_graph` with
    `scale=inf`, while `alignment.pose_graph` distrusts what fits badly. The file does not tell what
    was rejected, nor which edges are loops.

    Parameters
    ----------
    path : str or Path
        Packed where it ends in `.gz`.
    graph : Alignment or PoseGraph
        An alignment with a graph that weighs its edges, as `alignment.pose_graph` gives it; or the
        arrays themselves. Metres and radians, to the last digit.

    Raises
    ------
    ValueError
        For an alignment without such a graph; arrays of the wrong shape, values that are not
        finite, edges to rows that are not there, information that is negative or not symmetric.
    OSError
        A folder that does not exist, or cannot be written to.

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
    place, found = arrays.file(path), _checked(graph)
    names = _names(found.ids, len(found.poses))
    write_lines(place, [*_vertices(found, names), *_edges(found, names)])


def _checked(graph: Alignment | PoseGraph) -> PoseGraph:
    """The arrays of a graph, each as it must be."""
    if isinstance(graph, Alignment):
        graph = _of_alignment(graph)
    if not isinstance(graph, PoseGraph):
        raise ValueError(f"graph must be an Alignment or a PoseGraph, got {arrays.brief(graph)}")
    poses = arrays.poses(graph.poses, "graph.poses")
    edges = arrays.table(graph.edges, "graph.edges", 2, unit="rows of poses")
    ends = arrays.indices(edges, "graph.edges")
    if len(ends) and not (ends.min() >= 0 and ends.max() < len(poses)):
        got = f"{ends.min()} to {ends.max()}"
        raise ValueError(f"graph.edges must name rows 0 to {len(poses) - 1} of poses, got {got}")
    relative = arrays.poses(graph.relative, "graph.relative", count=len(ends))
    weight = information.checked(graph.information, len(ends))
    return PoseGraph(poses, ends, relative, weight, graph.ids)


def _of_alignment(found: Alignment) -> PoseGraph:
    graph = found.graph
    if graph is None or graph.information is None:
        raise ValueError(
            f"graph must be an alignment with a graph that weighs its edges, as "
            f"alignment.pose_graph gives it, got {found!r}"
        )
    return PoseGraph(found.poses, graph.edges, graph.relative, graph.information)


def _names(ids: NDArray[np.int64] | None, count: int) -> list[int]:
    """A number for each vertex."""
    if not count:
        raise ValueError("graph must hold at least one pose, got none")
    names = np.arange(count) if ids is None else arrays.indices(ids, "graph.ids")
    if names.shape != (count,) or names.min() < 0 or len(np.unique(names)) < count:
        raise ValueError(f"graph.ids must be {count} different numbers from 0, got {names}")
    found: list[int] = names.tolist()
    return found


def _vertices(graph: PoseGraph, names: list[int]) -> Iterator[str]:
    for name, pose in zip(names, graph.poses, strict=True):
        yield f"VERTEX_SE2 {name} {_row(pose)}"


def _edges(graph: PoseGraph, names: list[int]) -> Iterator[str]:
    turned = information.rotated(graph.information, graph.relative[:, 2])
    upper = turned.reshape(-1, 9)[:, [0, 1, 2, 4, 5, 8]]
    for (i, j), motion, six in zip(graph.edges.tolist(), graph.relative, upper, strict=True):
        yield f"EDGE_SE2 {names[i]} {names[j]} {_row(motion)} {_row(six)}"


def _row(values: Array) -> str:
    """Numbers with all their digits."""
    return " ".join(map(repr, values.tolist()))
