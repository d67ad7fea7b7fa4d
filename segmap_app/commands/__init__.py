"""The commands of `python -m segmap`, a file each: what was done, how many, how good, where it is.

The library never prints; only these do, results to the output and warnings and faults beside it.
A command is a function; its arguments, and the fields of its options, are what it is told.
"""

from . import _app, _compare, _convert, _info, _live, _locate, _map, _merge, _occupancy, _setup
from ._main import main
from .log_options import APP

__all__ = ["APP", "main"]
