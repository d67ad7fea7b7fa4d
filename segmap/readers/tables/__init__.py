"""Logs that are tables: CSV, arrays, dumps of cheap sensors, Hokuyo text, CoreSLAM, Rawseeds."""

from .._text import Binary
from . import _hokuyo_text, _npz, _rawseeds, _rostopic, _table, _wide
from ._coreslam import CoreSlam
from ._hokuyo_text import HokuyoText
from ._layout import first_rows, headed_of, layout_of, looks_like
from ._npz import log_from_arrays
from ._rawseeds import Rawseeds
from ._table import read_csv
from ._trajectories import read_trajectory, with_trajectories

__all__ = [
    "ARRAY_FILES", "GUESSED_FILES", "HEADED_FILES", "TABLE_FOLDERS", "TABLE_FORMATS", "CoreSlam",
    "HokuyoText", "Rawseeds", "first_rows", "headed_of", "layout_of", "log_from_arrays",
    "looks_like", "read_csv", "read_trajectory", "with_trajectories",
]  # fmt: skip

ARRAY_FILES = (Binary("NPZ", _npz.claims, _npz.read),)
#: Told by a head, or by names that stand in each line.
HEADED_FILES = (
    Binary("rostopic", _rostopic.is_echo, _rostopic.read_echo),
    Binary("table of scans", _wide.wide_of, _wide.read_wide),
    Binary("table", headed_of, _table.read),
)
#: What is taken for a table though nothing says so: where it has no other format.
GUESSED_FILES = (
    Binary("table", layout_of, _table.read),
    Binary("table of scans", _wide.bare_of, _wide.read_bare),
)
TABLE_FOLDERS = (
    Binary("Rawseeds", _rawseeds.files_of, _rawseeds.read_folder),
    Binary("Hokuyo text", _hokuyo_text.numbered, _hokuyo_text.read_hokuyo_folder),
)
TABLE_FORMATS = (HokuyoText, CoreSlam, Rawseeds)
