"""Scans of CSM, the canonical scan matcher: an object of JSON a line.

    {"nrays": 361, "theta": [...], "readings": [...], "odometry": [...], "true_pose": [...], ...}

Radians, metres and seconds; `null`, and what is not `valid`, is no measurement.

Assumed: the laser sits at the robot's centre.
"""

from __future__ import annotations

import json
from collections.abc import Sequence

import numpy as np

from ...arrays import Array
from ...scans import LaserScan, Log
from ..lines import Lines, pose_fields, time
from ..raw_scans import known_truth, or_none, place_of
from ..text import TextFormat


class Csm(TextFormat):
    """A log of CSM."""

    name, expected, separator = "CSM", "lines of JSON with theta and readings", "\n"

    def __init__(self, lines: Lines) -> None:
        super().__init__(lines)
        self.truth: list[Array] = []

    @classmethod
    def claims(cls, fields: Sequence[str]) -> bool:
        """Whether a line is one of this format."""
        line = fields[0]
        return line.startswith("{") and all(f'"{key}"' in line for key in ("nrays", "readings"))

    def _take(self, fields: list[str]) -> None:
        try:
            record = json.loads(fields[0])
            ranges, angles = (np.array(record[key], float) for key in ("readings", "theta"))
            valid = np.array(record.get("valid", np.ones(len(ranges))), float)
            seconds = [*(record.get("timestamp") or ["nan"]), 0]
            when = time(str(seconds[0])) + 1e-6 * float(seconds[1])
            odometry, true = (
                pose_fields(
                    [str("nan" if v is None else v) for v in record.get(key) or [None] * 3], key
                )
                for key in ("odometry", "true_pose")
            )
            scan = LaserScan(np.where(valid > 0, ranges, np.nan), angles, when, or_none(odometry))
        except (KeyError, TypeError, IndexError, AttributeError, RecursionError) as fault:
            raise ValueError(f"expected a scan of CSM ({type(fault).__name__}: {fault})") from fault
        self.scans.append(scan)
        self.truth.append(true)

    def _log(self, name: str) -> Log:
        placed = any(scan.odometry is not None for scan in self.scans)
        assumed = [place_of(np.zeros(3))] * placed
        truth = known_truth(np.array(self.truth))
        return Log(name, self.scans, truth, self.lines.skipped, assumed=assumed)
