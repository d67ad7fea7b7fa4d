"""What a chapter asks for and what its source notebook holds, cell by cell."""

import pytest
from segmap_course.grading import Task, chapters, tasks_of

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


def test_chapters_stand_in_their_order():
    assert list(chapters(" 17,\n02 ,")) == ["02", "17"] and list(chapters()) == sorted(chapters())
