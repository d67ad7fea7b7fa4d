"""What only the chapters need: exercises, lesson panels and drawings, and the theses' results."""

from .landscape_drawings import draw_climb, draw_landscape, draw_profile, draw_trials
from .landscape_panel import LandscapePanel
from .landscapes import Landscape, heading_profile, landscape, peaks, profile_peaks
from .matcher_panel import MatcherPanel
from .trials import (
    Trial,
    load_columns,
    load_trials,
    room_walk,
    room_walls,
    trial_table,
    try_pair,
    write_trials,
)

__all__ = [
    "Landscape",
    "LandscapePanel",
    "MatcherPanel",
    "Trial",
    "draw_climb",
    "draw_landscape",
    "draw_profile",
    "draw_trials",
    "heading_profile",
    "landscape",
    "load_columns",
    "load_trials",
    "peaks",
    "profile_peaks",
    "room_walk",
    "room_walls",
    "trial_table",
    "try_pair",
    "write_trials",
]
