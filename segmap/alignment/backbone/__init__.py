"""Backbone (A 3.3.2, 5.2): scans turn and move onto the lines of the building."""

from ._backbone import backbone, backbone_steps
from ._lines import BackboneStep, least_translation, mean_rotation

__all__ = ["BackboneStep", "backbone", "backbone_steps", "least_translation", "mean_rotation"]
