"""What is known of a log before it is aligned: beams, clock, odometry put right, and told."""

from ...scans.odometry import OdometryComparison
from ._odometry import compare_odometry
from ._prepared import prepared

__all__ = ["OdometryComparison", "compare_odometry", "prepared"]
