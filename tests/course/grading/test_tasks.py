"""What a chapter asks for and what its source notebook holds, cell by cell."""

import pytest
from segmap_course.grading import Task, chapters, source_notebook, tasks_of

#: Cells of a made-up chapter: those that begin with a capital are text.
SOURCES = (
    "Title, see [07](07_icp.ipynb#a) and [17](17_fusion.ipynb)",
    "import numpy as np\nfrom math import cos",
    "Write *compose*.",
    "import numpy as np\n\ndef my_compose(a, b): ...",
    "my_compose = my_compose",
    "print(my_compose)\ncourse.check_compose(my_compose)",
    "Predict. *3 points* if the program says so.",
    "my_guess = 0\n\ncourse.predict_beams_on_wall(\n    my_guess\n)\n",
    "| 2 | it passes |\n| 3 | a reason |",
    "my_walls, my_map = None, None",
    "course.break_reader(my_map)",
    "Draw it, by hand: 6 points",
    "my_log = my_poses = None\ncourse.check_own_log(my_log, my_poses)",
    "course.check_compose()",
)
NAME = "99_x.ipynb"


def made_up(*sources):
    kinds = [
        "markdown" if source[0].isupper() or source[0] == "|" else "code" for source in sources
    ]
    cells = [
        {"cell_type": kind, "id": f"c{k}", "metadata": {"tags": ["t"]} if k == 1 else {}}
        for k, kind in enumerate(kinds)
    ]
    cells = [cell | {"source": source} for cell, source in zip(cells, sources, strict=True)]
    return {"cells": cells, "nbformat": 4}


def test_the_tasks_of_a_chapter_are_read_whole():
    """Catches points of another rubric, and a task that nobody grades."""
    assert tasks_of(NAME, made_up(*SOURCES)) == [
        Task("compose", NAME, 4, ("my_compose",), "my_compose"),
        Task("predict_beams_on_wall", NAME, 3, ("my_guess",), "my_guess"),
        Task("break_reader", NAME, 2, ("my_map",), "my_map"),
        Task("break_reader_by_hand", NAME, 3),
        Task("by_hand_99_11", NAME, 6),
        Task("own_log_99_by_hand", NAME, 10),
    ]
    cells = "my_f = 1", "course.check_compose(my_f, later)", "my_f = later = 2"
    (found,) = tasks_of(NAME, made_up(*cells))
    assert found.answers == ("my_f",) and found.given == "(my_f, later)"
    with pytest.raises(ValueError, match="checks what no cell before it defines"):
        tasks_of(NAME, made_up(*cells[1:]))


def meta(name, points=None, **said):
    found = {"grade": False, "locked": False, "solution": False} | said
    worth = {} if points is None else {"points": points}
    return {"nbgrader": {**found, "grade_id": name, "schema_version": 3, "task": False, **worth}}


def test_a_source_notebook_is_written_whole():
    """Catches a cell that is lost or stands twice, a check in an answer, and points that differ."""
    source = source_notebook(NAME, made_up(*SOURCES), 7, ["17_fusion.ipynb", NAME])
    cells = [(c["id"], c["cell_type"], c["source"], c["metadata"]) for c in source["cells"]]
    assert source["nbformat"] == 4
    name = cells.pop(1)
    listed_points = (
        "- `compose`: 4 points\n- `predict_beams_on_wall`: 3 points\n- `break_reader`: 2 points\n"
        "- `break_reader_by_hand`: 3 points, graded by hand\n"
        "- `by_hand_99_11`: 6 points, graded by hand\n"
        "- `own_log_99_by_hand`: 10 points, graded by hand\n"
    )
    assert name[:2] == ("name", "markdown") and f"\n\n{listed_points}\nSave" in name[2]

    def points(task, said):
        return (f"{task}-points", "markdown", f"`{task}`: {said}", {})

    def by_hand(task, worth):
        said = f"*Write here ({worth} points, graded by hand).*"
        return (task, "markdown", said, meta(task, worth, grade=True, solution=True))

    def answer(task, source):
        (text,) = (text for id, _, text, _ in cells if id == f"{task}-answer")
        assert text.startswith(f"{source}\n\n\n### BEGIN SOLUTION\n")
        assert text.endswith("\n### END SOLUTION")
        return (f"{task}-answer", "code", text, meta(f"{task}-answer", solution=True))

    def checked(task, call, worth, hidden="", plain=""):
        test = f"{worth} * bool({plain or call})  # points: do not change{hidden}"
        locked = meta(f"{task}-test", worth, grade=True, locked=True)
        return [(f"{task}-check", "code", call, {}), (f"{task}-test", "code", test, locked)]

    check = "course.check_compose"
    hidden = (
        f"\n### BEGIN HIDDEN TESTS\n4 * bool({check}(my_compose) and "
        f"{check}(my_compose, {check}.hidden(7)))\n### END HIDDEN TESTS"
    )
    guess = "course.predict_beams_on_wall(\n    my_guess\n)"
    assert cells == [
        ("c0", "markdown", "Title, see 07 and [17](17_fusion.ipynb)", {}),
        ("c1", "code", SOURCES[1], {"tags": ["t"]}),
        ("c2", "markdown", SOURCES[2], {}),
        ("c3", "code", SOURCES[3], {}),
        points("compose", "**4 points** by the program"),
        answer("compose", SOURCES[4]),
        *checked("compose", "course.check_compose(my_compose)", 4, hidden),
        ("c6", "markdown", SOURCES[6], {}),
        points("predict_beams_on_wall", "**3 points** by the program"),
        answer("predict_beams_on_wall", "my_guess = 0"),
        *checked("predict_beams_on_wall", guess, 3, "", "course.predict_beams_on_wall(my_guess)"),
        ("c8", "markdown", SOURCES[8], {}),
        points("break_reader", "**2 points** by the program; **3 points** by hand"),
        answer("break_reader", SOURCES[9]),
        *checked("break_reader", SOURCES[10], 2),
        by_hand("break_reader_by_hand", 3),
        ("c11", "markdown", SOURCES[11], {}),
        by_hand("by_hand_99_11", 6),
        points("own_log_99", "**10 points** by hand"),
        answer("own_log_99", "my_log = my_poses = None"),
        ("own_log_99-check", "code", "course.check_own_log(my_log, my_poses)", {}),
        by_hand("own_log_99_by_hand", 10),
        ("c13", "code", SOURCES[13], {}),
    ]
    other = source_notebook("17_fusion.ipynb", made_up("Title"), 7)
    assert "- none\n" in other["cells"][1]["source"]


def test_chapters_stand_in_their_order():
    assert list(chapters(" 17,\n02 ,")) == ["02", "17"] and list(chapters()) == sorted(chapters())
