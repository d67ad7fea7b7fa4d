"""An answer that needs another cell: the check in the notebook and the grader say the same."""

import json
import subprocess
import sys

import pytest
import submitted
from segmap_course.grading import graded, plan_of

TURNED = "np.cos(h) * u - np.sin(h) * v, np.sin(h) * u + np.cos(h) * v"
HELPER = f"def rotated(h, u, v):\n    return {TURNED}\n"
SHORT = submitted.COMPOSE.replace(TURNED, "rotated(h, u, v)")
LIMIT = submitted.COMPOSE.replace("2 * np.pi", "WHOLE")
ROOT = submitted.COMPOSE.replace("x, y, h = a", "one = sqrt(1.0)\n    x, y, h = a")
SHOWN = f"{submitted.COMPOSE}display(3)\n"
STUB = "def my_compose(a_from_b, b_from_c):\n    ...\n"
#: What stands in the cells above the one with the answer, that cell, what both say of it, and the
#: kind that the grader calls it.
CASES = {
    "alone": ([], submitted.COMPOSE, "", "right"),
    "helper": ([HELPER], SHORT,
               "uses `rotated` of another cell: put it into this one", "other cell"),
    "helper inside": ([], HELPER + SHORT, "", "right"),
    "inner names": ([], submitted.COMPOSE.replace("= a_from_b", "= same(a_from_b)").replace(
        "    x, y", "    def same(n):\n        return [p for p in n]\n    x, y", 1), "", "right"),
    "constant": (["WHOLE = 6.283185307179586"], LIMIT,
                 "uses `WHOLE` of another cell: put it into this one", "other cell"),
    "both": ([HELPER + "WHOLE = 6.283185307179586"], SHORT.replace("2 * np.pi", "WHOLE"),
             "uses `WHOLE`, `rotated` of another cell: put them into this one", "other cell"),
    "import": (["%pwd\nfrom math import sqrt"], ROOT, "", "right"),
    "star": (["from math import *"], ROOT, "", "right"),
    "line": ([], "%pwd\n" + submitted.COMPOSE, "a command of Jupyter", "syntax"),
    "whole cell": ([], "%%capture\n" + submitted.COMPOSE, "a command of Jupyter", "syntax"),
    "shell": ([], submitted.COMPOSE + "!echo 3", "a command of Jupyter", "syntax"),
    "shown": ([], SHOWN, "uses `display`, which only a notebook has", "raised"),
    "second": ([submitted.WRONG], submitted.COMPOSE, "", "right"),
    "second wrong": ([submitted.COMPOSE], submitted.WRONG, "turn", "wrong"),
    "nothing": ([], STUB, "returns nothing yet", "empty"),
    "nothing new": ([], STUB.replace("...", "'''Mine.'''\n    return None"),
                    "returns nothing yet", "empty"),
}  # fmt: skip
NOTEBOOKS = """
import json, sys
from IPython.core.interactiveshell import InteractiveShell
shell = InteractiveShell()
shell.history_manager.enabled = False
for name, cells in json.loads(sys.stdin.read()).items():
    shell.reset()
    for text in cells:
        found = shell.run_cell(text, store_history=True, silent=False).result
    print(json.dumps([name, repr(found)]), file=sys.stderr)
"""


@pytest.fixture(scope="module")
def notebooks():
    """What the check says in a notebook, by the names of the cases."""
    begin = "import numpy as np\nimport segmap\nimport segmap_course as course"
    asked = {
        name: [begin, *above, cell, "course.check_compose(my_compose)"]
        for name, (above, cell, *_) in CASES.items()
    }
    asked["guess"] = [begin, "half = 7.5", "my_guess = 2 * half", GUESSED]
    asked["pure guess"] = [begin, "my_guess = 15", GUESSED]
    found = subprocess.run(
        [sys.executable, "-c", NOTEBOOKS], input=json.dumps(asked), capture_output=True, text=True,
        check=True,
    )  # fmt: skip
    return dict(json.loads(line) for line in found.stderr.splitlines() if line.startswith('["'))


GUESSED = "course.predict_beams_on_wall(my_guess)"


@pytest.fixture(scope="module")
def outcomes(tmp_path_factory):
    """What the grader says of the same cells."""
    folder = tmp_path_factory.mktemp("own_cell")
    for name, (above, cell, *_) in CASES.items():
        texts = [*((text, f"own{k}") for k, text in enumerate(above)), (cell, "compose-answer")]
        if name.startswith("second"):  # the handout's cell holds the first
            texts = [(above[0], "compose-answer"), (cell, "own")]
        cells = [{"cell_type": "code", "id": id, "source": text} for text, id in texts]
        (folder / f"{name}.ipynb").write_text(json.dumps({"cells": cells}))
    plan = plan_of("11", None)
    plan = plan._replace(tasks=[task for task in plan.tasks if task.name == "compose"])
    rows = graded(folder, plan, unprotected=True)
    return {row.submission.student: row.outcomes["compose"] for row in rows}


@pytest.mark.parametrize("name", CASES)
def test_the_notebook_and_the_grader_agree(name, notebooks, outcomes):
    """Catches an answer that passes in the student's notebook and has no points."""
    _, _, words, kind = CASES[name]
    assert outcomes[name].kind == kind
    if kind == "other cell":
        assert outcomes[name].reason == words
    assert words in notebooks[name] and (kind == "right") == (notebooks[name] == "passed")


def test_a_guess_that_needs_another_cell_is_told_too(notebooks):
    assert "uses `half` of another cell: put it into this one" in notebooks["guess"]
    assert notebooks["pure guess"].startswith("passed")
