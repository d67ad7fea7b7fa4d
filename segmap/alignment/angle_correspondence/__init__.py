"""Angle correspondence (A 2.5.1, 3.3.1): how two scans lie, from their walls alone."""

from ._angle_correspondence import angle_candidates, angle_correspondence, match_angles
from ._scenes import Candidate, match_values

__all__ = ["Candidate", "angle_candidates", "angle_correspondence", "match_angles", "match_values"]
