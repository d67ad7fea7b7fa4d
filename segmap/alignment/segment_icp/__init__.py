"""Segment ICP (A 2.5.1): a scan's segments moved onto those of the map."""

from ._segment_icp import ONE_DIRECTION, SIDEWAYS, match_segments, segment_icp

__all__ = ["ONE_DIRECTION", "SIDEWAYS", "match_segments", "segment_icp"]
