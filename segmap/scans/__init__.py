"""One turn of the laser, and a log of many with what else the robot recorded."""

from ._scans import (
    LONGEST_TURN_S,
    NO_POSE,
    NOTHING_SKIPPED,
    LaserScan,
    Log,
    Skipped,
)
from .noise import SensorNoise, sensor_noise

__all__ = [
    "LONGEST_TURN_S",
    "NOTHING_SKIPPED",
    "NO_POSE",
    "LaserScan",
    "Log",
    "SensorNoise",
    "Skipped",
    "sensor_noise",
]
