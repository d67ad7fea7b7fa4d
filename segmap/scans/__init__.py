"""One turn of the laser, and a log of many with what else the robot recorded."""

from ._scans import (
    NO_POSE,
    NOTHING_SKIPPED,
    LaserScan,
    Log,
    Skipped,
)
