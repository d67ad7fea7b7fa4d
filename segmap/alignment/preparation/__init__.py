"""What is known of a log before it is aligned: beams, clock, odometry put right, and told."""

from ._prepared import prepared

__all__ = ["prepared"]
