"""Handing out: the course folder of nbgrader, which grades, and tests for otter-grader."""

from ._cases import JUDGED, own_case
from ._handout import handout, source_notebook
from ._otter import otter_tests
from ._solutions import solution
from ._tasks import Task, chapters, read_chapter, tasks_of

__all__ = [
    "JUDGED", "Task", "chapters", "handout", "otter_tests", "own_case", "read_chapter", "solution",
    "source_notebook", "tasks_of",
]  # fmt: skip
