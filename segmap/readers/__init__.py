"""Log files: whatever a robot recorded becomes a `Log`.

`read` recognises the format by what is in the file; `load` reads a log that comes with segmap.
The file of each format says what it means to the field; `_formats` lists them, and those of other
packages join by the entry point `segmap.formats`. `read_segments` reads a map that
`exports.write_segments` wrote.
"""

from ._bundled import data_file
from ._read import format_of, load, read, together
from ._segments import read_segments
from .lines import HeadError, LogError, UnknownFormat
from .packed import read_text
from .raw_scans import half_turn
from .tables import (
    ColumnChoices,
    column_choices,
    read_csv,
    read_trajectory,
    with_trajectories,
)

__all__ = [
    "ColumnChoices", "HeadError", "LogError", "UnknownFormat", "column_choices", "data_file",
    "format_of", "half_turn", "load", "read", "read_csv", "read_segments", "read_text",
    "read_trajectory", "together",
    "with_trajectories",
]  # fmt: skip
