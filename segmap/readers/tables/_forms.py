"""Which tables there are, by what says that a file is one; and what is asked of the others."""

from pathlib import Path

from ..text import Binary
from ._columns import POSES_ALONE
from ._fixed import CoreSlam, HokuyoText, Rawseeds
from ._folders import files_of, numbered, read_folder, read_numbered
from ._layout import layout_of
from ._messages import is_csm, message_form_of, read_csm, read_messages
from ._question import choices_of
from ._table import read_declared
from ._trajectories import pose_layout_of

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
