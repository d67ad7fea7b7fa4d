"""A class of real submissions, graded by nbgrader itself: whatever one hands in, all have a row."""

import csv
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import psutil
import pytest
from handed_in import HEART, RIGHT
from programs import program

pytest.importorskip("nbgrader", reason="the extra `grading` brings it")
main = program("segmap_course")

BEGIN = "def my_compose(a, b):\n    "
#: Student -> the cell handed in, and its points of 4.
CELLS = {
    "right": (RIGHT, 4),
    "wrong": (BEGIN + "return a + b", 0),
    "empty": (None, 0),
    "by_heart": (f"{BEGIN}return {HEART}.get(repr((a, b)), [0, 0, 0])", 0),
    "endless_cell": ("import time\nwhile True: time.sleep(1)", 0),
    "endless_function": (BEGIN + "import time\n    while True: time.sleep(1)", 0),
    "deep_brackets": ("my_compose = " + "[" * 3000 + "]" * 3000, 0),
    "deep_answer": (BEGIN + "for _ in range(3000): a = [a]\n    return a", 0),
    "kills_the_kernel": ("import os\nos.kill(os.getpid(), 9)", 0),
    "kills_in_the_check": (BEGIN + "import os; os._exit(0)", 0),
    "no_notebook": ("{", 0),
    # INSTRUCTOR.md says so in bold
    "fools_the_check": ("type(course.check_compose).__call__ = lambda *_: True\nmy_compose = 1", 4),
}


def hand_in(release: Path, folder: Path, cell: str | None, whole: bool) -> None:
    """The release with an answer; where it is not `whole`, with what the answer needs alone."""
    book = json.loads(release.read_text())
    if not whole:
        book["cells"] = [
            c
            for c in book["cells"]
            if "nbgrader" in c["metadata"] or "import segmap_course" in "".join(c["source"])
        ]
    for each in book["cells"]:
        if each["id"] == "compose-answer" and cell is not None:
            each["source"] = cell
    folder.mkdir(parents=True)
    (folder / release.name).write_text("{" if cell == "{" else json.dumps(book))


@pytest.fixture(scope="module")
def graded(tmp_path_factory):
    """The table of the class by student, after `handout`, `autograde` and `export`."""
    course = tmp_path_factory.mktemp("robotics")
    assert main(["handout", str(course / "lab1"), "--chapters", "02", "--seed", "4711"]) == 0
    (release,) = (course / "release" / "lab1").iterdir()
    for student, (cell, _) in CELLS.items():
        hand_in(release, course / "submitted" / student / "lab1", cell, student == "right")
    room = course / "runtime"
    room.mkdir()  # the kernels' connection files stand in it, and its name in their commands
    scripts = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    env = os.environ | {"TMPDIR": str(room), "PATH": scripts}
    for words in (["autograde", "lab1", "--ExecutePreprocessor.timeout=120"], ["export"]):
        done = subprocess.run(
            [sys.executable, "-m", "nbgrader", *words],
            **dict(cwd=course, env=env, capture_output=True, text=True, check=False),
        )
        print(done.stderr)
    left = [p for p in psutil.process_iter(["cmdline"]) if str(room) in str(p.info["cmdline"])]
    with (course / "grades.csv").open(newline="") as table:
        return release, {row["student_id"]: row for row in csv.DictReader(table)}, left


@pytest.mark.slow
def test_every_student_has_a_row_whatever_another_handed_in(graded):
    """Catches an answer that ends the grading of the others, or goes on when it is over."""
    _, rows, left = graded
    assert {student: float(row["score"]) for student, row in rows.items()} == {
        student: points for student, (_, points) in CELLS.items()
    }
    assert {float(row["max_score"]) for row in rows.values()} == {4.0}
    assert left == []


@pytest.mark.slow
def test_the_release_holds_neither_solution_nor_hidden_case(graded):
    """Catches marks that nbgrader does not know, and a stub that no longer runs."""
    release, *_ = graded
    text = release.read_text()
    assert not any(word in text for word in ("SOLUTION", "HIDDEN", "4711", "hidden("))
    cells = {cell["id"]: "".join(cell["source"]) for cell in json.loads(text)["cells"]}
    exec(cells["compose-answer"], space := {"np": np})
    assert space["my_compose"](1, 2) is None
