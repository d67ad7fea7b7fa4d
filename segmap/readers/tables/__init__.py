"""Logs that are tables: CSV, arrays, dumps of cheap sensors, Hokuyo text, CoreSLAM, Rawseeds."""

from .._text import Binary
from . import _fixed, _folders, _messages, _npz, _table, _wide
from ._advice import first_rows, looks_like
from ._fixed import CoreSlam, HokuyoText, Rawseeds
from ._folders import one_scan_each, read_in_order
from ._layout import headed_of, layout_of
from ._npz import log_from_arrays
from ._table import read_csv
from ._trajectories import read_trajectory, with_trajectories

__all__ = [
    "ARRAY_FILES", "GUESSED_FILES", "HEADED_FILES", "TABLE_FOLDERS", "TABLE_FORMATS", "CoreSlam",
    "HokuyoText", "Rawseeds", "first_rows", "headed_of", "layout_of", "log_from_arrays",
    "looks_like", "one_scan_each", "read_csv", "read_in_order", "read_trajectory",
    "with_trajectories",
]  # fmt: skip

ARRAY_FILES = (Binary("NPZ", _npz.claims, _npz.read),)
#: Told by a head, or by names that stand in each line.
HEADED_FILES = (
    Binary("records", _messages.records_of, _messages.read_named_records),
    Binary("table of scans", _wide.scans_of, _table.reader_of(_wide.scans_of)),
    Binary("table", headed_of, _table.reader_of(_table.stated)),
)
#: What is taken for a table though nothing says so: where it has no other format.
GUESSED_FILES = (
    Binary("table", layout_of, _table.reader_of(_table.stated)),
    Binary("table of scans", _fixed.bare_of, _table.reader_of(_fixed.bare_of)),
)
TABLE_FOLDERS = (
    Binary("Rawseeds", _folders.files_of, _folders.read_folder),
    Binary("numbered scans", _folders.numbered, _folders.read_numbered),
)
TABLE_FORMATS = (HokuyoText, CoreSlam, Rawseeds)
