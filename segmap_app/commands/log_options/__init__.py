"""What commands share: the logs and options that are named, poses of their scans, files written."""

from ._command import Command, examples
from ._logs import (
    add_logs,
    add_output,
    add_strict,
    allowed,
    check_places,
    concluded,
    each_log,
    finished,
    is_log,
    is_session,
    log_of,
)
from ._poses import (
    add_align,
    add_poses,
    add_world,
    call,
    check_options,
    edits_of,
    placed_outcome,
    recipe_of,
    tell_alignment,
    tell_deskewing,
    tell_poses,
)
from ._settings import parsed
from ._table import NO_MAP
from ._thresholds import LENGTH, add_thresholds, refuse_others, refuse_wrong, thresholds

__all__ = [
    "LENGTH", "NO_MAP", "Command", "add_align", "add_logs", "add_output",
    "add_poses", "add_strict", "add_thresholds", "add_world", "allowed", "call",
    "check_options", "check_places", "concluded", "each_log", "edits_of", "examples",
    "finished", "is_log", "is_session", "log_of", "parsed", "placed_outcome",
    "recipe_of", "refuse_others", "refuse_wrong", "tell_alignment", "tell_deskewing",
    "tell_poses", "thresholds",
]  # fmt: skip
