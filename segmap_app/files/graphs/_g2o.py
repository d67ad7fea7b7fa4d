"""g2o pose graphs that carry their scans.

    VERTEX2 id x y theta          (or VERTEX_SE2)
    ROBOTLASER1 ...               as in CARMEN, see `_carmen`

The vertex before a laser line is the robot's corrected pose at that scan; a scan without a vertex
of its own has none. The robot's pose in the laser line is its odometry, unless it is 0 0 0 in all
of them. Edges and other lines of the graph are skipped.

Assumed: where no vertex says more, the laser sits at the robot's centre.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from segmap.arrays import Array
from segmap.readers.carmen import parse_robotlaser
from segmap.readers.lines import Lines, float_fields, pose_fields
from segmap.readers.raw_scans import (
    NOWHERE,
    Extrinsic,
    RawScan,
    assemble,
    extrinsic_by_poses,
    known_truth,
)
from segmap.readers.text import TextFormat
from segmap.scans import Log

VERTICES = ("VERTEX2", "VERTEX_SE2")
G2O_LASERS = ("ROBOTLASER1", "ROBOTLASER2")
#: Lines that g2o and gtsam write besides: priors, bearings, switches, landmarks, parameters.
LEFT_OUT = re.compile(r"(EDGE|VERTEX|PARAMS|LANDMARK|PRIOR|BR|FIX)(_[A-Z0-9_]+)?")
G2O_OTHERS = ("EDGE2", "EDGE_SE2", "EDGE_SE2_XY", "VERTEX_XY", "FIX", "PARAMS_SE2OFFSET", "EQUIV")


class G2o(TextFormat):
    """A g2o graph with scans."""

    name, keywords = "g2o", (*VERTICES, *G2O_LASERS, *G2O_OTHERS)
    expected = "a ROBOTLASER1 line after each vertex"

    def __init__(self, lines: Lines) -> None:
        super().__init__(lines)
        self.truth: list[Array] = []
        self.vertex = NOWHERE

    def _take(self, fields: list[str]) -> None:
        if fields[0] in VERTICES:
            self.vertex = NOWHERE
            float_fields(fields[1:2], "the vertex")
            self.vertex = pose_fields(fields[2:], "the vertex")
        elif fields[0] in G2O_LASERS:
            self.scans.append(parse_robotlaser(fields))
            self.truth.append(self.vertex)
            self.vertex = NOWHERE
        elif fields[0] not in G2O_OTHERS and not LEFT_OUT.fullmatch(fields[0]):
            raise ValueError(f"expected a line of a g2o graph, got {fields[0][:40]!r}")

    def _finish(self) -> list[RawScan]:
        """The scans, without odometry where it is 0 0 0 in all of them."""
        if any(scan.odometry.any() for scan in self.scans):
            return self.scans
        return [scan._replace(odometry=NOWHERE, pose=NOWHERE) for scan in self.scans]

    def _extrinsic(self, laser: str, scans: Sequence[RawScan]) -> Extrinsic:
        backwards = np.pi if laser == "ROBOTLASER2" else 0.0
        return extrinsic_by_poses(scans, np.array([0.0, 0.0, backwards]))

    def _log(self, name: str) -> Log:
        scans, _, assumed = assemble(self._finish(), self._extrinsic)
        truth = known_truth(np.array(self.truth))
        return Log(name, scans, truth, self.lines.skipped, assumed=assumed)
