"""Pose graphs as g2o files.

    VERTEX_SE2 id x y theta
    EDGE_SE2 id id dx dy dtheta  I11 I12 I13 I22 I23 I33

The motion is the second vertex as seen from the first. g2o measures what is left of it in the frame
where the motion ends, `solve_graph` in the frame where it begins: the information is turned. The
older VERTEX2 and EDGE2 of TORO order it as I11 I12 I22 I33 I13 I23. Of a robot in a plane the
VERTEX_SE3:QUAT and EDGE_SE3:QUAT are projected on it, with a warning, and so are the VERTEX3 and
EDGE3 of TORO; the information of the former is of half an angle. Scans, landmarks, fixed vertices,
priors, bearings, switches and parameters are left out, and counted.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from segmap.arrays import LARGEST_COORDINATE, Array, unit_checks
from segmap.exports import PoseGraph
from segmap.files import shown
from segmap.poses.information import SYMMETRIC, rotated
from segmap.readers.lines import Lines, LogError, float_fields, pose_fields
from segmap.readers.mounting import in_space, level
from segmap.readers.packed import log_file

from ._g2o import G2O_LASERS, G2O_OTHERS, LEFT_OUT, VERTICES

#: Of each kind of edge: where the nine entries of the information stand among the six in the file.
ORDERS = {"EDGE_SE2": (0, 1, 2, 1, 3, 4, 2, 4, 5), "EDGE2": (0, 1, 4, 1, 2, 5, 4, 5, 3)}
#: Poses in space, by a quaternion or by roll, pitch and yaw, and motions between them.
QUATERNIONS = ("VERTEX_SE3:QUAT", "EDGE_SE3:QUAT")
ANGLES = ("VERTEX3", "EDGE3")
#: Of the 21 entries of the information of such an edge those in the plane, and what makes them of a
#: whole angle: g2o's is the vector of a quaternion.
PLANE_ENTRIES = (0, 1, 5, 6, 10, 20)
WHOLE_ANGLE = np.array([1, 1, 0.5, 1, 0.5, 0.25])
#: A robot that tilts by more than this, radians, is in no plane.
MOST_TILT_IN_PLANE = np.radians(20)


def read_graph(path: str | Path) -> PoseGraph:
    """Read a pose graph of g2o, plain or packed: what `exports.write_graph` and gtsam write.

    Lines are VERTEX_SE2 and EDGE_SE2, VERTEX2 and EDGE2 of TORO, or those in space of a robot in a
    plane, which are projected; poses are ordered by the numbers of the
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
    lost = np.empty((0, 2))  # height and tilt of poses in space
    with log_file(path) as place:
        lines = Lines(place)
        for kind, *fields in lines:
            try:
                if kind in (*QUATERNIONS, *ANGLES):
                    kind, fields, more = _in_plane(kind, fields)
                    lost = np.vstack([lost, more]).max(0, keepdims=True)
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
    for height, tilt in lost * (1, 180 / np.pi):
        words = f"poses in space are projected: up to {height:.3g} m, {tilt:.3g} degrees are lost"
        unit_checks.warn(f"{shown(place)}: {words}")
    if not poses:
        raise LogError(place, "holds no vertex of a graph, expected VERTEX_SE2 lines")
    whole = np.int64 if max(poses) <= np.iinfo(np.int64).max else np.uint64
    ids = np.array(sorted(poses), whole)
    for line, i, j, _ in found:
        if missing := [end for end in (i, j) if end not in poses]:
            raise LogError(place, f"vertex {missing[0]} is not in the file", line)
    edges = np.searchsorted(ids, np.array([edge[1:3] for edge in found], whole).reshape(-1, 2))
    values = np.reshape([edge[3] for edge in found], (-1, 12))
    relative = values[:, :3]
    information = rotated(values[:, 3:].reshape(-1, 3, 3), -relative[:, 2])
    order = np.array([poses[k] for k in ids])
    return PoseGraph(order, edges, relative, information, ids, left_out)


def _in_plane(kind: str, fields: Sequence[str]) -> tuple[str, list[str], Array]:
    """A line of a graph in space as one in the plane; and its height, metres, and tilt, radians."""
    begin, by_angles = 1 if kind.startswith("VERTEX") else 2, kind in ANGLES
    count = 6 if by_angles else 7
    found = float_fields(fields[begin : begin + count], "the pose")
    if len(found) != count:
        what = "roll, pitch and yaw" if by_angles else "a quaternion"
        raise ValueError(f"expected x, y, z and {what}, got {len(found)} fields")
    turn = _quaternion(found[3:]) if by_angles else found[[6, 3, 4, 5]].tolist()
    pose = in_space(found[:3].tolist(), turn)
    tilt = float(np.arccos(np.clip(pose[2, 2], -1, 1)))
    if tilt > MOST_TILT_IN_PLANE:
        said = f"{np.degrees(tilt):.0f} degrees"
        raise ValueError(f"expected poses of a robot in a plane, got one that is tilted by {said}")
    plane = [*fields[:begin], *map(repr, level(pose).tolist())]
    lost = np.array([abs(found[2]), tilt])
    if begin == 1:
        return "VERTEX_SE2", plane, lost
    entries = float_fields(fields[begin + count :], "the information of the edge")
    if len(entries) != 21:
        raise ValueError(f"expected 21 entries of information, got {len(entries)}")
    six = entries[list(PLANE_ENTRIES)] * (1 if by_angles else WHOLE_ANGLE)
    return "EDGE_SE2", [*plane, *map(repr, six.tolist())], lost


def _quaternion(angles: Array) -> list[float]:
    """w, x, y, z of a turn by roll, then pitch, then yaw, radians."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(angles / 2), np.sin(angles / 2)
    turn = [cr * cp * cy + sr * sp * sy, sr * cp * cy - cr * sp * sy]
    return [*map(float, [*turn, cr * sp * cy + sr * cp * sy, cr * cp * sy - sr * sp * cy])]


def _vertex_number(fields: Sequence[str], place: int) -> int:
    """The number of a vertex."""
    field = fields[place] if len(fields) > place else ""
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
