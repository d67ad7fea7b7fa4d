"""Logs that are tables of declared columns, arrays, folders, Hokuyo text, CoreSLAM, Rawseeds."""

from pathlib import Path

from ..text import Binary
from ._columns import POSES_ALONE
from ._fixed import CoreSlam, HokuyoText, Rawseeds
from ._folders import files_of, numbered, one_scan_each, read_folder, read_in_order, read_numbered
from ._layout import Layout, layout_of, said_beside
from ._messages import is_csm, message_form_of, read_csm, read_messages
from ._npz import ARRAYS, log_from_arrays
from ._question import ColumnChoices, choices_of, column_choices
from ._table import read_csv, read_declared, read_declared_rows
from ._trajectories import pose_layout_of, read_trajectory, with_trajectories

__all__ = [
    "ARRAYS", "STATED_FILES", "TABLE_FOLDERS", "TABLE_FORMATS", "ColumnChoices", "CoreSlam",
    "HokuyoText", "Rawseeds", "asked_of", "column_choices", "log_from_arrays", "one_scan_each",
    "read_csv", "read_declared_rows", "read_in_order", "read_trajectory", "said_beside",
    "with_trajectories",
]  # fmt: skip


#: So many rows of numbers without names are a table.
LEAST_ROWS = 3


def is_table(path: Path) -> bool:
    """Whether a file says that it is a table, though perhaps not enough."""
    layout = layout_of(path)
    return bool(layout.names) or layout.is_headed


#: Told by a head, or by names that stand in each line.
STATED_FILES = (
    Binary("text of ROS", message_form_of, read_messages),
    Binary("CSM", is_csm, read_csm),
    Binary("table", is_table, read_declared),
)
TABLE_FOLDERS = (
    Binary("Rawseeds", files_of, read_folder),
    Binary("numbered scans", numbered, read_numbered),
)
TABLE_FORMATS = (HokuyoText, CoreSlam, Rawseeds)


def asked_of(path: Path) -> str:
    """What is asked of a file that holds rows of numbers and no name of them; empty of another."""
    layout = layout_of(path)
    if pose_layout_of(path).names:
        return POSES_ALONE
    are_numbers = len(layout.rows) >= LEAST_ROWS and 2 * sum(layout.kinds) >= len(layout.kinds)
    return choices_of(layout).told(path.name) if are_numbers else ""
