"""Tests for otter-grader, a file a task: the check of the chapter, and hidden cases of the seed."""

from __future__ import annotations

from pathlib import Path
from pprint import pformat

from ._tasks import Task

HEAD = ">>> import segmap_course as course\n"
FILE = '''\
"""The task {name} of {chapter}, with the seed of its hidden cases: for teachers alone."""

OK_FORMAT = True

test = {test}
'''


def otter_tests(tasks: list[Task], seed: int) -> dict[str, str]:
    """File -> its text, in a folder for each chapter: `02_scans_poses_drift/compose.py`."""
    asked = [task for task in tasks if not task.by_hand]
    return {f"{Path(t.chapter).stem}/{t.name}.py": otter_test(t, seed) for t in asked}


def otter_test(task: Task, seed: int) -> str:
    """The test of a task in otter's OK format: all points are those of its last case."""
    shown = task.calls(seed)
    cases = [
        {
            "code": f"{HEAD}>>> found = {call}\n>>> assert found, found",
            "hidden": number > 0,
            "points": task.points if call == shown[-1] else 0,
        }
        for number, call in enumerate(shown)
    ]
    suite = {"cases": cases, "scored": True, "setup": "", "teardown": "", "type": "doctest"}
    test = {"name": task.name, "points": None, "suites": [suite]}
    return FILE.format(name=task.name, chapter=task.chapter, test=pformat(test, sort_dicts=False))
