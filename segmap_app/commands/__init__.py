"""The commands of `python -m segmap`, a file each: what was done, how many, how good, where it is.

The library never prints; only these do, results to the output and warnings and faults beside it.
A command is a function `add(commands)`, which names its arguments, and one of these that does it.
"""

from ._main import main, parser

__all__ = ["main", "parser"]
