"""A function that passes its check is kept in `my_mapper.py`, in a student's copy alone."""

import subprocess
import sys
from pathlib import Path

import nbformat
import pytest
import segmap_course as course
from chapter_rules import ROOT
from nbclient import NotebookClient
from segmap_course.literal.alignment.plain_mapper import Functions

RIGHT = """\
import numpy as np
import segmap_course as course
from segmap.angles import wrap

TURNS = 1.0

def turned(step, heading):
    c, s = np.cos(heading), np.sin(heading)
    return np.array([c * step[0] - s * step[1], s * step[0] + c * step[1]])

def my_compose(a_from_b, b_from_c):
    there = a_from_b[:2] + turned(b_from_c, a_from_b[2])
    return np.array([*there, *[wrap(a_from_b[2] + TURNS * h) for h in b_from_c[2:]]])
"""
USE = "import my_mapper; print(my_mapper.compose((1, 2, 0), (1, 0, 0)))"


def printed(folder: Path, *cells: str) -> list[str]:
    """What each cell of a notebook in a folder shows as its value."""
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(cell) for cell in cells])
    NotebookClient(notebook, resources={"metadata": {"path": str(folder)}}).execute()
    return [
        output["data"]["text/plain"]
        for cell in notebook.cells
        for output in cell.outputs
        if output.output_type == "execute_result"
    ]


def test_what_passes_is_kept_with_what_it_uses_and_runs_alone(tmp_path):
    """Catches a helper, a number or an import that is left behind, a second copy, and a grader's
    cases that write."""
    (tmp_path / "my_mapper.py").write_text('"""Mine."""\n')
    check = "course.check_compose(my_compose)"
    other = RIGHT.replace("there = ", "there = np.zeros(2) + ")
    hidden = "course.check_compose(my_compose, course.check_compose.fresh(3))"
    graded, *shown = printed(
        tmp_path, RIGHT, hidden, check, check, other, check, "my_compose = max", check
    )
    assert (
        graded == "passed" and shown[0] == "passed: kept in my_mapper.py" and shown[1] == "passed"
    )
    assert "below the one of before" in shown[2] and shown[3].startswith("not yet")
    text = (tmp_path / "my_mapper.py").read_text()
    assert text.startswith('"""Mine."""\n') and text.count("def my_compose") == 2
    command = [sys.executable, "-W", "error", "-c", USE]
    answer = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
    assert answer.stdout.split() == ["[2.", "2.", "0.]"]


def test_nothing_is_written_where_no_student_works(tmp_path):
    """Catches a file in the project's folder, at a refresh or in a grader's."""
    assert printed(tmp_path, RIGHT, "course.check_compose(my_compose)") == ["passed"]
    assert not list(tmp_path.iterdir())


def test_what_cannot_be_kept_is_told(tmp_path):
    """Catches a file that does not run alone, and a pass that turns into an error."""
    (tmp_path / "my_mapper.py").write_text("")
    without_name = RIGHT + "\nmy_compose = lambda a, b, f=my_compose: f(a, b)"
    listed = RIGHT.replace("TURNS = 1.0", "TURNS = [1.0]").replace("TURNS *", "TURNS[0] *")
    check = "course.check_compose(my_compose)"
    words = "a lambda has no name", "it uses TURNS, a variable"
    for shown, reason in zip(
        printed(tmp_path, without_name, check, listed, check), words, strict=True
    ):
        assert shown.startswith("passed: not kept in my_mapper.py: ") and reason in shown
    assert (tmp_path / "my_mapper.py").read_text() == ""


# ------------------------------------------------------------------ chapter 30 maps with them
NAMES = Functions._fields
OF_RIGHT = "from right_answers import RIGHT\n" + "".join(f"{n} = RIGHT[{n!r}]\n" for n in NAMES)
CHAPTER = ROOT / "notebooks" / "30_a_map_by_your_own_functions.ipynb"


@pytest.mark.slow
def test_six_right_functions_map_the_clinic(tmp_path, monkeypatch):
    """Catches a mapper that takes the library's instead, and one that only its arrays suit."""
    (tmp_path / "my_mapper.py").write_text(OF_RIGHT)
    monkeypatch.setenv("PYTHONPATH", str(ROOT / "tests"))
    notebook = nbformat.read(CHAPTER, 4)
    truth = "[float(abs(poses - log.truth)[:, :2].max()) for poses in (chain, closed)]"
    notebook.cells.append(nbformat.v4.new_code_cell(f"assert {truth}[1] < 0.2 < {truth}[0]"))
    NotebookClient(notebook, resources={"metadata": {"path": str(tmp_path)}}).execute()
    shown = "".join(o.get("text", "") for cell in notebook.cells for o in cell.get("outputs", []))
    assert shown.count(": yours\n") == 2 * len(NAMES) and "the library's" not in shown


@pytest.mark.parametrize("name", NAMES)
def test_a_function_that_is_missing_or_wrong_is_named_and_replaced(tmp_path, capsys, name):
    """Catches a wrong function that maps, and a line that names another one."""
    for added, words in (
        (f"del {name}\n", "my_mapper.py does not have it"),
        (f"def {name}(*given): ...\n", "yours does not pass: it returns nothing yet"),
        (f"{name} = 7\n", "yours does not pass: give the function itself"),
    ):
        (tmp_path / "my_mapper.py").write_text(OF_RIGHT + added)
        mine = course.check_my_mapper(tmp_path)
        lines = capsys.readouterr().out.splitlines()
        (line,) = (line for line in lines if not line.endswith(": yours"))
        assert line.startswith(f"{name} ") and words in line and len(lines) == len(NAMES)
        check = course.EXERCISES[name]
        given = next(iter(check.cases.values()))
        assert check.same(getattr(mine, name)(*given), check.solution(*given))


def test_a_file_that_does_not_run_is_told(tmp_path, capsys):
    """Catches an error of a student's file that stops the chapter."""
    (tmp_path / "my_mapper.py").write_text("def compose(:")
    course.check_my_mapper(tmp_path)
    assert capsys.readouterr().out.count("my_mapper.py does not run: SyntaxError") == len(NAMES)
