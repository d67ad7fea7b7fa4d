"""What commands share: the logs and options that are named, poses of their scans, files written."""

from ._logs import allowed, concluded, each_log, finished, is_session, log_of, refuse_maps
from ._methods import FAMILIES, call_of, thresholds
from ._options import (
    AS_IT_IS,
    File,
    Laser,
    LogOptions,
    Logs,
    PlacedOptions,
    PosedOptions,
    Unasked,
)
from ._poses import placed_outcome, recipe_of, tell_alignment, tell_deskewing, tell_poses
from ._program import APP, checked, command, method, output, parsed, quantity

__all__ = [
    "APP", "AS_IT_IS", "FAMILIES", "File", "Laser", "LogOptions", "Logs", "PlacedOptions",
    "PosedOptions", "Unasked", "allowed", "call_of", "checked", "command", "concluded", "each_log",
    "finished", "is_session", "log_of", "method", "output", "parsed", "placed_outcome", "quantity",
    "recipe_of", "refuse_maps", "tell_alignment", "tell_deskewing", "tell_poses", "thresholds",
]  # fmt: skip
