"""One turn of the laser, and a log of many with what else the robot recorded."""

from ._scans import (
    NO_POSE,
    NOTHING_SKIPPED,
    LaserScan,
    Log,
    Skipped,
)

__all__ = ["NOTHING_SKIPPED", "NO_POSE", "LaserScan", "Log", "Skipped"]
