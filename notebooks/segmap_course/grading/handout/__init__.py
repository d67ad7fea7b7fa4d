"""Handing out: student copies of the chapters, and solutions from the library's own source."""

from ._given import listed, package
from ._handout import KIND, handout
from ._solutions import write_solutions
from ._tasks import CHECKS, Task, chapters, defines, read_chapter, tasks_of

__all__ = [
    "CHECKS", "KIND", "Task", "chapters", "defines", "handout", "listed", "package", "read_chapter",
    "tasks_of", "write_solutions",
]  # fmt: skip
