"""Logs that are tables of declared columns, arrays, folders, CoreSLAM, Rawseeds."""

from ._folders import one_scan_each, read_in_order
from ._forms import TABLE, TABLE_FOLDERS, TABLE_FORMATS, asked_of, read_csv
from ._layout import layout_in_toml
from ._npz import ARRAYS, log_from_arrays
from ._question import ColumnChoices, column_choices
from ._table import read_declared_rows
from ._trajectories import read_trajectory, with_trajectories

__all__ = [
    "ARRAYS", "TABLE", "TABLE_FOLDERS", "TABLE_FORMATS", "ColumnChoices", "asked_of",
    "column_choices", "layout_in_toml", "log_from_arrays", "one_scan_each", "read_csv",
    "read_declared_rows", "read_in_order", "read_trajectory", "with_trajectories",
]  # fmt: skip
