"""Global alignment of segments (A 2.5.1): all scans at once."""

from ._global_segments import global_segments

__all__ = ["global_segments"]
