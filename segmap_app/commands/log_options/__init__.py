"""What commands share: the logs and options that are named, poses of their scans, files written."""

from ._command import Command, checked, examples, quantity, switch, told
from ._logs import (
    add_logs,
    add_output,
    add_strict,
    allowed,
    check_places,
    concluded,
    each_log,
    finished,
    is_session,
    log_of,
)
from ._methods import call_of, thresholds, word_of
from ._poses import (
    add_align,
    add_poses,
    add_world,
    check_world,
    edits_of,
    placed_outcome,
    recipe_of,
    tell_alignment,
    tell_deskewing,
    tell_poses,
)
from ._settings import FAMILIES, parsed

__all__ = [
    "FAMILIES", "Command", "add_align", "add_logs", "add_output", "add_poses", "add_strict",
    "add_world", "allowed", "call_of", "check_places", "check_world", "checked", "concluded",
    "each_log", "edits_of", "examples", "finished", "is_session", "log_of", "parsed",
    "placed_outcome", "quantity", "recipe_of", "switch", "tell_alignment", "tell_deskewing",
    "tell_poses", "thresholds", "told", "word_of",
]  # fmt: skip
