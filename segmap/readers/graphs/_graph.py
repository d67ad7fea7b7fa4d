"""Pose graphs as g2o files.

    VERTEX_SE2 id x y theta
    EDGE_SE2 id id dx dy dtheta  I11 I12 I13 I22 I23 I33

The motion is the second vertex as seen from the first. g2o measures what is left of it in the frame
where the motion ends, `solve_graph` in the frame where it begins: the information is turned. The
older VERTEX2 and EDGE2 of TORO order it as I11 I12 I22 I33 I13 I23. Scans, landmarks, fixed
vertices, priors, bearings, switches and parameters are left out, and counted.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...arrays import LARGEST_COORDINATE, Array
from ...poses.information import SYMMETRIC, rotated
from .._lines import Lines, LogError, float_fields, pose_fields
from ..packed import log_file
from ._g2o import G2O_LASERS, G2O_OTHERS, VERTICES

#: Lines that g2o and gtsam write besides: priors, bearings, switches, landmarks, parameters.
LEFT_OUT = re.compile(r"(?!.*SE3)(EDGE|VERTEX|PARAMS|LANDMARK|PRIOR|BR|FIX)(_[A-Z0-9_]+)?")
#: Of each kind of edge: where the nine entries of the information stand among the six in the file.
ORDERS = {"EDGE_SE2": (0, 1, 2, 1, 3, 4, 2, 4, 5), "EDGE2": (0, 1, 4, 1, 2, 5, 4, 5, 3)}


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
    ids: NDArray[np.int64] | None = None  #: (n,): names of the vertices; None: their rows
    left_out: Mapping[str, int] = MappingProxyType({})  #: lines that do not concern the poses


def read_graph(path: str | Path) -> PoseGraph:
    """Read a pose graph of g2o, plain or packed: what `exports.write_graph` and gtsam write.

    Lines are VERTEX_SE2 and EDGE_SE2, or VERTEX2 and EDGE2; poses are ordered by the numbers of the
    vertices.

    Raises
    ------
    LogError
        A file that cannot be read or has no vertex; a damaged line, an edge to a vertex that the
        file does not hold, two vertices of one number, information that is negative.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "it.g2o"
    ...     _ = path.write_text("VERTEX_SE2 3 0 0 0\\nVERTEX_SE2 5 1 0 0\\n"
    ...                         "EDGE_SE2 3 5 1.1 0 0 9 0 0 9 0 9\\n")
    ...     graph = read_graph(path)
    >>> graph.edges, graph.relative, graph.ids
    (array([[0, 1]]), array([[1.1, 0. , 0. ]]), array([3, 5]))
    """
    poses: dict[int, Array] = {}
    left_out: dict[str, int] = {}
    found: list[tuple[int, int, int, Array]] = []
    with log_file(path) as place:
        lines = Lines(place)
        for kind, *fields in lines:
            try:
                if kind in VERTICES:
                    number = _vertex_number(fields, 0)
                    if number in poses:
                        raise ValueError(
                            f"vertex {number} stands in the file twice, expected it once"
                        )
                    poses[number] = pose_fields(fields[1:], "the vertex")
                    if np.isnan(poses[number]).any():
                        raise ValueError("expected metres and radians for the vertex, got nan")
                elif kind in ORDERS:
                    ends = _vertex_number(fields, 0), _vertex_number(fields, 1)
                    found.append((lines.number, *ends, _measured_motion(fields[2:], ORDERS[kind])))
                elif kind in (*G2O_OTHERS, *G2O_LASERS) or LEFT_OUT.fullmatch(kind):
                    left_out[kind] = left_out.get(kind, 0) + 1
                else:
                    raise ValueError(f"expected a VERTEX_SE2 or EDGE_SE2 line, got {kind[:40]!r}")
            except ValueError as fault:
                raise lines.error(str(fault)) from None
    if not poses:
        raise LogError(place, "holds no vertex of a graph, expected VERTEX_SE2 lines")
    ids = np.array(sorted(poses), np.int64)
    for line, i, j, _ in found:
        if missing := [end for end in (i, j) if end not in poses]:
            raise LogError(place, f"vertex {missing[0]} is not in the file", line)
    edges = np.searchsorted(ids, np.array([edge[1:3] for edge in found], np.int64).reshape(-1, 2))
    values = np.reshape([edge[3] for edge in found], (-1, 12))
    relative = values[:, :3]
    information = rotated(values[:, 3:].reshape(-1, 3, 3), -relative[:, 2])
    order = np.array([poses[k] for k in ids])
    return PoseGraph(order, edges, relative, information, ids, left_out)


def _vertex_number(fields: Sequence[str], place: int) -> int:
    """The number of a vertex."""
    field = fields[place] if len(fields) > place else ""
    if not re.fullmatch("[0-9]{1,19}", field) or int(field) > np.iinfo(np.int64).max:
        raise ValueError(f"expected the number of a vertex, got {field[:40]!r}")
    return int(field)


def _measured_motion(fields: Sequence[str], order: Sequence[int]) -> Array:
    """A motion and the nine entries of its information, (12,) array."""
    motion, six = (
        pose_fields(fields[:3], "the edge"),
        float_fields(fields[3:], "the information of the edge"),
    )
    if len(six) != 6 or np.isnan(motion).any() or not (np.abs(six) <= LARGEST_COORDINATE).all():
        raise ValueError(
            "expected 3 finite numbers for the motion of the edge and 6 for its information, got "
            f"{' '.join(fields)[:120]}"
        )
    entries = six[list(order)]
    if np.linalg.eigvalsh(entries.reshape(3, 3))[0] < -SYMMETRIC * np.abs(six).max():
        raise ValueError(f"expected information that is nowhere negative, got {six.tolist()}")
    return np.concatenate([motion, entries])
