"""What commands share: the logs and options that are named, poses of their scans, files written."""

from ._logs import conclude, each_log, finish, is_session, log_of, outputs, refuse_maps
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
from ._program import APP, checked, command, method, output, parse, quantity

__all__ = [
    "APP", "AS_IT_IS", "FAMILIES", "File", "Laser", "LogOptions", "Logs", "PlacedOptions",
    "PosedOptions", "Unasked", "call_of", "checked", "command", "conclude", "each_log", "finish",
    "is_session", "log_of", "method", "output", "outputs", "parse", "placed_outcome", "quantity",
    "recipe_of", "refuse_maps", "tell_alignment", "tell_deskewing", "tell_poses", "thresholds",
]  # fmt: skip
