"""Student copies: nothing of the outputs, the solutions or the seed; links that lead somewhere."""

import json
import re

import pytest
from chapter_rules import CHAPTERS
from programs import program
from segmap_course import EXERCISES, OPEN_EXERCISES
from segmap_course.grading.handout import defines
from submitted import solution

main = program("segmap_course")


@pytest.fixture(scope="module")
def handed(tmp_path_factory):
    """All chapters, handed out with a seed."""
    folder = tmp_path_factory.mktemp("course") / "students"
    assert main(["handout", str(folder), "--seed", "987654321"]) == 0
    return folder


def cells(path):
    return json.loads(path.read_text(encoding="utf-8"))["cells"]


def all_cells(folder):
    return [(path, cell) for path in sorted(folder.iterdir()) for cell in cells(path)]


def test_every_chapter_is_there_without_outputs(handed):
    assert [p.name for p in sorted(handed.iterdir())] == [p.name for p in CHAPTERS]
    code = [cell for _, cell in all_cells(handed) if cell["cell_type"] == "code"]
    assert len(code) > 300
    assert all(cell["outputs"] == [] and cell["execution_count"] is None for cell in code)
    assert all(cells(path)[1]["source"].startswith("**Name:**") for path in handed.iterdir())


def test_the_seed_is_with_the_instructor_alone(handed):
    """Catches a seed in the metadata of a copy, and one that holds a solution."""
    key = handed.with_name("students.instructor.json")
    assert json.loads(key.read_text())["seed"] == 987654321
    assert key.stat().st_mode & 0o077 == 0
    assert not any(
        word in p.read_text()
        for p in handed.iterdir()
        for word in ("987654321", "### BEGIN SOLUTION")
    )


def test_every_exercise_of_the_chapters_has_an_answer_a_check_and_points(handed):
    """Catches a chapter whose exercise is written in another way, and is lost."""
    called = r"^course\.check_(\w+)\("
    asked = {
        name
        for path in CHAPTERS
        for cell in cells(path)
        for name in re.findall(called, "".join(cell["source"]), re.M)
    }
    held = {cell["id"]: cell for _, cell in all_cells(handed)}
    assert {name for name in asked if name in EXERCISES} <= {
        name.removesuffix("-test") for name in held if name.endswith("-test")
    }
    for name in asked & set(EXERCISES):
        assert "course.check" not in held[f"{name}-answer"]["source"]
        assert f"4 * bool(course.check_{name}(" in held[f"{name}-test"]["source"]


def test_a_copy_is_what_nbgrader_reads(handed):
    schema = pytest.importorskip("nbgrader.nbgraderformat.v3")
    nbformat = pytest.importorskip("nbformat")
    for path in handed.iterdir():
        notebook = nbformat.read(path, as_version=4)
        nbformat.validate(notebook)
        assert any("nbgrader" in cell.metadata for cell in notebook.cells)
        schema.MetadataValidatorV3().validate_nb(notebook)


def test_grade_ids_are_unique_and_so_are_cells(handed):
    for path in handed.iterdir():
        found = cells(path)
        ids = [cell["id"] for cell in found]
        graded = [c["metadata"]["nbgrader"] for c in found if "nbgrader" in c["metadata"]]
        assert len(set(ids)) == len(ids)
        assert len({meta["grade_id"] for meta in graded}) == len(graded)


def test_stubs_fail(handed):
    """Catches an answer that comes with its solution."""
    bodies = {"...", "return None  # yours", "None"}
    for _, cell in all_cells(handed):
        if cell["id"].endswith("-answer") and "def " in cell["source"]:
            last = cell["source"].splitlines()[-1].partition("): ")[2] or cell["source"]
            assert any(last.strip().startswith(b) or last.strip().endswith(b) for b in bodies)


def test_links_lead_to_a_file_of_the_handout(tmp_path):
    assert main(["handout", str(tmp_path / "two"), "--chapters", "34,54"]) == 0
    text = "".join(
        c["source"] for _, c in all_cells(tmp_path / "two") if c["cell_type"] == "markdown"
    )
    targets = set(re.findall(r"\]\(([^)#\s]+)", text))
    assert targets == {"34_icp.ipynb", "54_fusion.ipynb"} & targets
    assert "not part of this handout" in text and "Ground truth" in text


def test_what_is_wrong_is_said_at_the_door(tmp_path, capsys):
    def refused(*arguments):
        assert main(["handout", *map(str, arguments)]) == 1
        return capsys.readouterr().err

    assert "no chapter has the number 99; there are 00, 01" in refused(
        tmp_path / "a", "--chapters", "99"
    )
    assert not (tmp_path / "a").exists()
    (tmp_path / "mine").mkdir()
    for name in ("a", "b", "c", "thesis.txt"):
        (tmp_path / "mine" / name).write_text("x")
    assert "holds a, b, c already" in refused(tmp_path / "mine")
    assert "is a file" in refused(tmp_path / "mine" / "thesis.txt")
    (tmp_path / "b.instructor.json").write_text("{}")
    assert "with the seed of a handout" in refused(tmp_path / "b", "--chapters", "34")
    assert [path.name for path in tmp_path.iterdir() if path.name.startswith(".")] == []
    for seed in ("-1", "x", "1.5"):
        with pytest.raises(SystemExit):
            main(["handout", str(tmp_path / "c"), "--seed", seed])
        assert "whole number from 0 on" in capsys.readouterr().err or seed == "-1"


def test_a_definition_is_seen_and_nothing_else():
    assert defines("x = 1\nmy_f: int = 3", "my_f") and defines("def my_f (x):", "my_f")
    assert not defines("  my_f = 3", "my_f") and not defines("def my_fit(x):", "my_f")


# ------------------------------------------------------------------ solutions


def test_solutions_stand_between_the_marks_of_nbgrader(tmp_path):
    assert main(["solutions", str(tmp_path / "source"), "--chapters", "13,34"]) == 0
    (guess,) = (
        cell["source"]
        for cell in cells(tmp_path / "source" / "13_simulated_rooms" / "13_simulated_rooms.ipynb")
        if cell["id"] == "predict_beams_on_wall-answer"
    )
    assert guess.endswith("### BEGIN SOLUTION\nmy_beams = 15  # beams\n### END SOLUTION")
    path = tmp_path / "source" / "34_icp" / "34_icp.ipynb"
    held = {cell["id"]: cell for cell in cells(path)}["move_onto_walls-answer"]
    before, rest = held["source"].split("### BEGIN SOLUTION")
    assert "def my_move_onto_walls(" in before and "..." in before
    assert "my_move_onto_walls = " in rest.split("### END SOLUTION")[0] and "def " in rest
    assert main(["solutions", str(tmp_path / "source")]) == 1


@pytest.mark.parametrize("name", OPEN_EXERCISES)
def test_the_open_exercises_are_answered_too(name):
    """Catches an input that no longer fools the method, and a measured number that is not near."""
    mine, source = solution(name)
    exec(source, space := {})
    made = [space[one] for one in mine.split(", ")]
    assert OPEN_EXERCISES[name](made[0] if len(made) == 1 else tuple(made))
