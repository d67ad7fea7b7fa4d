"""g2o pose graphs that carry their scans.

    VERTEX2 id x y theta          (or VERTEX_SE2)
    ROBOTLASER1 ...               as in CARMEN, see `_carmen`

The vertex before a laser line is the robot's corrected pose at that scan; a scan without a vertex
of its own has none. The robot's pose in the laser line is its odometry, unless it is 0 0 0 in all
of them. Edges and other lines of the graph are skipped.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ...arrays import Array
from ...scans import Log
from .._lines import Lines, numbers, pose
from .._raw_scans import NOWHERE, Extrinsic, RawScan, assemble, extrinsic_by_poses
from ..carmen import parse_robotlaser

VERTICES = ("VERTEX2", "VERTEX_SE2")
LASERS = ("ROBOTLASER1", "ROBOTLASER2")
OTHERS = ("EDGE2", "EDGE_SE2", "EDGE_SE2_XY", "VERTEX_XY", "FIX", "PARAMS_SE2OFFSET", "EQUIV")


def claims(fields: Sequence[str]) -> bool:
    """Whether a line is one of this format."""
    return fields[0] in (*VERTICES, *LASERS, *OTHERS)


class _Graph:
    """What the lines of one graph said so far."""

    def __init__(self) -> None:
        self.scans: list[RawScan] = []
        self.truth: list[Array] = []
        self.vertex = NOWHERE

    def take(self, fields: list[str]) -> None:
        """Take in one line."""
        if fields[0] in VERTICES:
            self.vertex = NOWHERE
            numbers(fields[1:2], "the vertex")
            self.vertex = pose(fields[2:], "the vertex")
        elif fields[0] in LASERS:
            self.scans.append(parse_robotlaser(fields))
            self.truth.append(self.vertex)
            self.vertex = NOWHERE
        elif fields[0] not in OTHERS:
            raise ValueError(f"expected a line of a g2o graph, got {fields[0][:40]!r}")


def read(path: Path, name: str, on_error: str = "raise") -> Log:
    """Read a g2o graph with scans; `truth` `(k, 3)`, metres and radians, are its vertices."""
    lines, graph = Lines(path, on_error), _Graph()
    for _ in lines.each(graph.take):
        pass
    if not graph.scans:
        raise lines.no_scan("a ROBOTLASER1 line after each vertex")
    raw = _without_zeros(graph.scans)
    scans, _ = assemble(raw, _extrinsic)
    truth = np.array(graph.truth)
    return Log(name, scans, truth if np.isfinite(truth).any() else None, lines.skipped)


def _without_zeros(scans: list[RawScan]) -> list[RawScan]:
    recorded = any(scan.odometry.any() for scan in scans)
    return scans if recorded else [s._replace(odometry=NOWHERE, pose=NOWHERE) for s in scans]


def _extrinsic(laser: str, scans: Sequence[RawScan]) -> Extrinsic:
    backwards = np.pi if laser == "ROBOTLASER2" else 0.0
    return extrinsic_by_poses(scans, np.array([0.0, 0.0, backwards]))
