"""Pose graphs as g2o files.

    VERTEX_SE2 id x y theta
    EDGE_SE2 id id dx dy dtheta  I11 I12 I13 I22 I23 I33

The motion is the second vertex as seen from the first. g2o measures what is left of it in the frame
where the motion ends, `solve_graph` in the frame where it begins: the information is turned. The
older VERTEX2 and EDGE2 of TORO order it as I11 I12 I22 I33 I13 I23. Scans, landmarks, fixed
vertices, priors, bearings, switches and parameters are left out, and counted. Graphs in space
(VERTEX_SE3:QUAT, VERTEX3) are refused.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from segmap.arrays import LARGEST_COORDINATE, Array
from segmap.exports import PoseGraph
from segmap.poses.information import SYMMETRIC, rotate
from segmap.readers.lines import Lines, LogError, float_fields, pose_fields
from segmap.readers.packed import log_file

from ._g2o import G2O_LASERS, G2O_OTHERS, LEFT_OUT, VERTICES

#: Of each kind of edge: where the nine entries of the information stand among the six in the file.
ORDERS = {"EDGE_SE2": (0, 1, 2, 1, 3, 4, 2, 4, 5), "EDGE2": (0, 1, 4, 1, 2, 5, 4, 5, 3)}


def read_graph(path: str | Path) -> PoseGraph:
    """Read a pose graph of g2o, plain or packed: what `exports.write_graph` and gtsam write.

    Lines are VERTEX_SE2 and EDGE_SE2, or VERTEX2 and EDGE2 of TORO; poses are ordered by the
    numbers of the vertices.

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
    left_out = Counter[str]()
    measured: list[tuple[int, int, int, Array]] = []

    def take(fields: list[str]) -> None:
        kind, *rest = fields
        if kind in VERTICES:
            number = _vertex_number(rest[:1])
            if number in poses:
                raise ValueError(f"vertex {number} stands in the file twice, expected it once")
            poses[number] = pose_fields(rest[1:], "the vertex")
            if np.isnan(poses[number]).any():
                raise ValueError("expected metres and radians for the vertex, got nan")
        elif kind in ORDERS:
            ends = _vertex_number(rest[:1]), _vertex_number(rest[1:2])
            measured.append((lines.number, *ends, _measured_motion(rest[2:], ORDERS[kind])))
        elif kind in (*G2O_OTHERS, *G2O_LASERS) or LEFT_OUT.fullmatch(kind):
            left_out[kind] += 1
        else:
            raise ValueError(f"expected a VERTEX_SE2 or EDGE_SE2 line, got {kind[:40]!r}")

    with log_file(path) as place:
        lines = Lines(place)
        for _ in lines.each(take):
            pass
    if not poses:
        raise LogError(place, "holds no vertex of a graph, expected VERTEX_SE2 lines")
    for line, *ends, _ in measured:
        if missing := [end for end in ends if end not in poses]:
            raise LogError(place, f"vertex {missing[0]} is not in the file", line)
    whole = np.int64 if max(poses) <= np.iinfo(np.int64).max else np.uint64
    ids = np.array(sorted(poses), whole)
    edges = np.searchsorted(ids, np.array([edge[1:3] for edge in measured], whole).reshape(-1, 2))
    numbers = np.reshape([edge[3] for edge in measured], (-1, 12))
    relative = numbers[:, :3]
    information = rotate(numbers[:, 3:].reshape(-1, 3, 3), -relative[:, 2])
    return PoseGraph(
        np.array([poses[k] for k in sorted(poses)]), edges, relative, information, ids, left_out
    )


def _vertex_number(fields: Sequence[str]) -> int:
    """The number of a vertex, in the first field."""
    field = fields[0] if fields else ""
    if not re.fullmatch("[0-9]{1,20}", field) or int(field) > np.iinfo(np.uint64).max:
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
