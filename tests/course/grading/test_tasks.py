"""What a chapter asks for and what its copies hold, cell by cell; solutions run by themselves."""

import json
import os
import stat
from pathlib import Path

import pytest
from segmap_course import EXERCISES, OPEN_EXERCISES
from segmap_course.grading.handout import (
    Task,
    chapters,
    handout,
    listed,
    package,
    tasks_of,
    write_solutions,
)
from submitted import solution

#: Cells of a made-up chapter: those that begin with a capital are text.
SOURCES = (
    "Title, see [34](34_icp.ipynb#a) and [54](54_fusion.ipynb)",
    "import numpy as np\nfrom math import cos",
    "Write *compose*.",
    "import numpy as np\n\ndef my_compose(a, b): ...",
    "my_compose = my_compose",
    "print(my_compose)\ncourse.check_compose(my_compose)",
    "Predict. *3 points* if the program says so.",
    "my_guess = 0\n\ncourse.predict_beams_on_wall(\n    my_guess\n)\n",
    "| 2 | it passes |\n| 3 | a reason |",
    "my_walls, my_map = None, None",
    "course.break_quality(my_map)",
    "Draw it, by hand: 6 points",
    "my_log = my_poses = None\ncourse.check_own_log(my_log, my_poses)",
    "course.check_compose()",
)
NAME, FIRST = "99_x.ipynb", "00_start_here.ipynb"


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
    """Catches points of another rubric, a stub with its check, and a task that nobody grades."""
    head = "import numpy as np\nfrom math import cos"
    rubric, own = SOURCES[8], "Draw it, by hand: 6 points"
    assert tasks_of(NAME, made_up(*SOURCES)) == [
        Task(
            "compose",
            NAME,
            ("my_compose",),
            4,
            head,
            "my_compose",
            False,
            "Write *compose*.",
            "my_compose = my_compose",
        ),
        Task(
            "predict_beams_on_wall",
            NAME,
            ("my_guess",),
            3,
            head,
            "my_guess",
            False,
            SOURCES[6],
            "my_guess = 0",
        ),
        Task("break_quality", NAME, ("my_map",), 2, head, "my_map", False, rubric, SOURCES[9]),
        Task("break_quality_by_hand", NAME, (), 3, by_hand=True, rubric=rubric),
        Task("by_hand_99_11", NAME, (), 6, by_hand=True, rubric=own),
        Task("own_log_99_by_hand", NAME, (), 10, by_hand=True, rubric=own),
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


@pytest.fixture
def clone(tmp_path, monkeypatch):
    """Chapters of a clone: one that is made up, another that it links to."""
    folder = tmp_path / "clone" / "notebooks"
    folder.mkdir(parents=True)
    for name, sources in ((NAME, SOURCES), ("54_fusion.ipynb", ["Title"]), (FIRST, ["Title"])):
        (folder / name).write_text(json.dumps(made_up(*sources)))
    monkeypatch.setattr("segmap.files.__file__", str(folder.parent / "segmap" / "files.py"))


def test_a_student_s_copy_is_written_whole(clone, tmp_path):
    """Catches a cell that is lost or stands twice, a check in an answer, and points that differ."""
    handout(tmp_path / "lab", wanted="54,99")
    copy = json.loads((tmp_path / "lab" / NAME).read_text())
    held = [(c["id"], c["cell_type"], c["source"], c["metadata"]) for c in copy["cells"]]
    assert copy["nbformat"] == 4 and all(
        (cell["outputs"], cell["execution_count"]) == ([], None)
        for cell in copy["cells"]
        if cell["cell_type"] == "code"
    )
    name = held.pop(1)
    listed_points = (
        "- `compose`: 4 points\n- `predict_beams_on_wall`: 3 points\n- `break_quality`: 2 points\n"
        "- `break_quality_by_hand`: 3 points, graded by hand\n"
        "- `by_hand_99_11`: 6 points, graded by hand\n"
        "- `own_log_99_by_hand`: 10 points, graded by hand\n"
    )
    assert name[:2] == ("name", "markdown") and f"\n\n{listed_points}\nAn answer" in name[2]
    given = listed(EXERCISES["compose"])

    def points(task, said):
        return (f"{task}-points", "markdown", f"`{task}`: {said}", {})

    def by_hand(task, worth):
        said = f"*Write here ({worth} points, graded by hand).*"
        return (task, "markdown", said, meta(task, worth, grade=True, solution=True))

    def answer(task, source):
        return (f"{task}-answer", "code", source, meta(f"{task}-answer", solution=True))

    def checked(task, call, worth):
        test = f"{worth} * bool({call})  # points: do not change"
        locked = meta(f"{task}-test", worth, grade=True, locked=True)
        return [(f"{task}-check", "code", call, {}), (f"{task}-test", "code", test, locked)]

    assert held == [
        ("c0", "markdown", "Title, see 34 and [54](54_fusion.ipynb)", {}),
        ("c1", "code", SOURCES[1], {"tags": ["t"]}),
        ("c2", "markdown", SOURCES[2], {}),
        ("c3", "code", SOURCES[3], {}),
        points("compose", f"**4 points** by the program; of segmap it may call {given}"),
        answer("compose", SOURCES[4]),
        *checked("compose", "course.check_compose(my_compose)", 4),
        ("c6", "markdown", SOURCES[6], {}),
        points("predict_beams_on_wall", "**3 points** by the program"),
        answer("predict_beams_on_wall", "my_guess = 0"),
        *checked("predict_beams_on_wall", "course.predict_beams_on_wall(\n    my_guess\n)", 3),
        ("c8", "markdown", SOURCES[8], {}),
        points("break_quality", "**2 points** by the program; **3 points** by hand"),
        answer("break_quality", SOURCES[9]),
        *checked("break_quality", SOURCES[10], 2),
        by_hand("break_quality_by_hand", 3),
        ("c11", "markdown", SOURCES[11], {}),
        by_hand("by_hand_99_11", 6),
        points("own_log_99", "**10 points** by hand"),
        answer("own_log_99", "my_log = my_poses = None"),
        ("own_log_99-check", "code", "course.check_own_log(my_log, my_poses)", {}),
        by_hand("own_log_99_by_hand", 10),
        ("c13", "code", SOURCES[13], {}),
    ]
    other = json.loads((tmp_path / "lab" / "54_fusion.ipynb").read_text())
    assert "- none\n" in other["cells"][1]["source"]


def test_a_handout_is_written_whole_or_not_at_all(tmp_path, monkeypatch):
    """Catches a key that others read, a half-written folder, and a seed that can be guessed."""
    folder = tmp_path / "far" / "new" / "lab"
    key, tasks = handout(folder, wanted="11,13", seed=0)
    assert key == folder.parent / "lab.instructor.json"
    assert stat.S_IMODE(key.stat().st_mode) == 0o600
    held = json.loads(key.read_text())
    assert key.read_text() == json.dumps(held, indent=1) + "\n"
    assert held == {
        "format": "segmap handout 1",
        "seed": 0,
        "tasks": [task._asdict() | {"answers": list(task.answers)} for task in tasks],
    }
    names = [path.name for path in chapters("11 13").values()]
    assert sorted(path.name for path in folder.iterdir()) == names
    assert [path.name for path in folder.parent.iterdir() if path.name[0] == "."] == []
    made = (folder / names[0]).read_bytes()
    assert made.decode() == json.dumps(json.loads(made), indent=1, ensure_ascii=False) + "\n"
    monkeypatch.setattr("secrets.randbits", lambda bits: bits)
    key, _ = handout(tmp_path / "x", wanted="11")
    assert json.loads(key.read_text())["seed"] == 128, "bits that nobody can guess"
    with pytest.raises(ValueError, match="whole number from 0 on, got -1"):
        handout(tmp_path / "y", seed=-1)
    (tmp_path / ".z.part").mkdir()
    (tmp_path / ".z.part" / "left").write_text("over")
    with monkeypatch.context() as patch:
        patch.setattr(Path, "replace", lambda part, folder: os.close(-1))
        with pytest.raises(OSError):
            handout(tmp_path / "z", wanted="11")
    assert not (tmp_path / "z").exists() and not (tmp_path / ".z.part").exists()
    assert write_solutions(tmp_path / "z", "11,13") == 2
    made = sorted((tmp_path / "z").glob("*/*.ipynb"))
    assert [path.name for path in made] == names
    (tmp_path / "held").mkdir()
    (tmp_path / "held" / "a").touch()
    with pytest.raises(ValueError, match="holds a already"):
        write_solutions(tmp_path / "held", "11")
    assert [path.name for path in (tmp_path / "held").iterdir()] == ["a"]


def test_chapters_stand_in_their_order():
    assert list(chapters(" 54,\n34 ,")) == ["34", "54"] and list(chapters()) == sorted(chapters())


@pytest.mark.parametrize("name", EXERCISES)
def test_a_solution_is_right_with_what_its_task_gives(name):
    """Catches a solution that lacks what it calls, or is refused since it calls the library."""
    exercise = EXERCISES[name]
    (mine, source), rooms = solution(name), package(exercise)[1]
    given = [f"from {room} import {one}" for room, names in rooms.items() for one in names]
    assert {line for line in source.splitlines() if "import" in line and "segmap" in line} <= {
        *given
    }
    exec(source, space := {})
    assert exercise.verdict(exercise.answers(space[mine]))


@pytest.mark.parametrize("name", EXERCISES)
def test_what_a_task_gives_is_the_most_that_does_not_reach_its_answer(name):
    """Catches basics that are lost, or carry the solution in their source or by what they call."""
    source, given = package(EXERCISES[name])
    every = [package(exercise)[1] for exercise in EXERCISES.values()]
    held = {one for given in every for names in given.values() for one in names}
    kept = {one for names in given.values() for one in names}
    assert list(given) == list(every[0]) and name not in kept
    assert len(held - kept) <= 6, held - kept
    lines = source.splitlines()
    head = [line.split()[1] for line in lines if line.startswith(("import ", "from "))]
    assert head[0] == "__future__" and not any(module.startswith("segmap") for module in head)
    exec(source, space := {})
    assert all(callable(space[one]) for one in kept)
    code = [found.__code__.co_code for found in space.values() if hasattr(found, "__code__")]
    solution = EXERCISES[name].solution
    assert getattr(solution, "__code__", len).co_code not in code if callable(solution) else True


def test_a_list_of_what_a_task_gives_is_read_as_words():
    words = listed(EXERCISES["compose"])
    assert words.startswith("`segmap.angles`: wrap, axial_difference, axial_mean")
    assert "`segmap.poses`: " in words and "compose" not in words
    assert OPEN_EXERCISES.keys().isdisjoint(EXERCISES)
