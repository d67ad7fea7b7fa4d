"""Log files: whatever a robot recorded becomes a `Log`.

`read` recognises the format by what is in the file; `load` reads a log that comes with segmap.
The file of each format says what it means to the field; `_formats` lists them. `read_segments`
reads a map that `exports.write_segments` wrote, `read_graph` a pose graph of g2o, `read_session` a
log with what was made of it.
"""

from ._bundled import data_file
from ._lines import HeadError, LogError, UnknownFormat
from ._raw_scans import half_turn
from ._read import format_of, load, read, together
from ._segments import read_segments
from ._session import Session, read_session
from .bags import read_bag
from .graphs import PoseGraph, read_graph
from .packed import read_text
from .tables import (
    ColumnChoices,
    column_choices,
    read_csv,
    read_trajectory,
    with_trajectories,
)

__all__ = [
    "ColumnChoices", "HeadError", "LogError", "PoseGraph", "Session", "UnknownFormat",
    "column_choices", "data_file", "format_of", "half_turn", "load", "read", "read_bag",
    "read_csv", "read_graph", "read_segments", "read_session", "read_text", "read_trajectory",
    "together",
    "with_trajectories",
]  # fmt: skip
