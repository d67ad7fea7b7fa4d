"""g2o pose graphs that carry their scans.

    VERTEX2 id x y theta          (or VERTEX_SE2)
    ROBOTLASER1 ...               as in CARMEN, see `_robotlaser`

The vertex before a laser line is the robot's corrected pose at that scan; a scan without a vertex
of its own has none. The robot's pose in the laser line is its odometry, unless it is 0 0 0 in all
of them. Edges and other lines of the graph are skipped.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ..arrays import Array
from ..scans import Log
from ._beams import no_return
from ._fields import numbers, pose
from ._lines import Lines
from ._robotlaser import parse
from ._shots import NOWHERE, Mounted, Shot, assemble, mount_by_poses

VERTICES = ("VERTEX2", "VERTEX_SE2")
LASERS = ("ROBOTLASER1", "ROBOTLASER2")
OTHERS = ("EDGE2", "EDGE_SE2", "EDGE_SE2_XY", "VERTEX_XY", "FIX", "PARAMS_SE2OFFSET", "EQUIV")


def claims(fields: Sequence[str]) -> bool:
    """Whether a line is one of this format."""
    return fields[0] in (*VERTICES, *LASERS, *OTHERS)


class _Graph:
    def __init__(self) -> None:
        self.shots: list[Shot] = []
        self.truth: list[Array] = []
        self.vertex = NOWHERE

    def take(self, fields: list[str]) -> None:
        """Take in one line."""
        if fields[0] in VERTICES:
            self.vertex = NOWHERE
            numbers(fields[1:2], "the vertex")
            self.vertex = pose(fields[2:], "the vertex")
        elif fields[0] in LASERS:
            self.shots.append(parse(fields))
            self.truth.append(self.vertex)
            self.vertex = NOWHERE
        elif fields[0] not in OTHERS:
            raise ValueError(f"expected a line of a g2o graph, got {fields[0][:40]!r}")


def read(path: Path, name: str, on_error: str = "raise") -> Log:
    """Read a g2o graph with scans; `truth` `(k, 3)`, metres and radians, are its vertices."""
    lines, graph = Lines(path, on_error), _Graph()
    for _ in lines.each(graph.take):
        pass
    if not graph.shots:
        raise lines.no_scan("a ROBOTLASER1 line after each vertex")
    shots = _without_zeros(graph.shots)
    limit = no_return(shot.ranges for shot in shots)
    limits = np.array([min(shot.limit, limit) for shot in shots])
    scans, _ = assemble(shots, _mount, limits)
    truth = np.array(graph.truth)
    return Log(name, scans, truth if np.isfinite(truth).any() else None, lines.skipped)


def _without_zeros(shots: list[Shot]) -> list[Shot]:
    recorded = any(shot.odometry.any() for shot in shots)
    return shots if recorded else [s._replace(odometry=NOWHERE, pose=NOWHERE) for s in shots]


def _mount(laser: str, shots: Sequence[Shot]) -> Mounted:
    backwards = np.pi if laser == "ROBOTLASER2" else 0.0
    return mount_by_poses(shots, np.array([0.0, 0.0, backwards]))
