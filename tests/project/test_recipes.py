"""The recipes of CONTRIBUTING can be followed: a made-up example of each, in a copy of the project.

An example writes what the recipe asks for, and nothing else; then the test command that stands at
the end of the recipe must pass, and have tests to run.
"""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import nbformat
import pytest

ROOT = Path(__file__).resolve().parents[2]
CONTRIBUTING = (ROOT / "CONTRIBUTING.md").read_text()
WRITTEN = ROOT / "tests/recipes"
READERS, SAMPLES = "segmap/readers/carmen", "tests/log_samples.py"
CHAPTER = "notebooks/43_walls_by_hand"
EXERCISES, COURSE = "notebooks/segmap_course/exercises", "notebooks/segmap_course/__init__.py"

#: The recipe's heading -> files that are written, with the names of their texts in `tests/recipes`,
#: and (file, what stands there, what it becomes).
EXAMPLES = {
    "A new reader": (
        {f"{READERS}/_paces.py": "paces"},
        [
            (f"{READERS}/__init__.py", "from ._player", "from ._paces import Paces\nfrom ._player"),
            (f"{READERS}/__init__.py", '"Player", ', '"Paces",\n    "Player", '),
            (f"{READERS}/__init__.py", "WeanHall)", "WeanHall, Paces)"),
            (
                SAMPLES,
                "SINGLE_FILES = {\n",
                '_PACE = "PACE {odometry} {time} 5 1.50 2.00 2.50 81.83 3.00"\n'
                'SINGLE_FILES = {\n    "paces": text(twice(_PACE)),\n',
            ),
            (
                SAMPLES,
                "ASSUMED = {\n",
                'ASSUMED = {\n    "paces": {FIVE, CENTRE, SICK_REACH.format(50)},\n',
            ),
        ],
    ),
    "A new reduction method": (
        {
            "segmap/reduction/_near_middle.py": "near_middle",
            "tests/reduction/test_near_middle.py": "test_near_middle",
        },
        [
            (
                "segmap/reduction/_methods.py",
                "from ._runner import",
                "from ._near_middle import near_middle\nfrom ._runner import",
            ),
            (
                "segmap/reduction/_methods.py",
                "METHODS = Methods(\n",
                "METHODS = Methods(\n    near_middle=Method(\n        near_middle,\n        "
                '"ours",\n        merges="m -> 1",\n        keeps="end points",\n        '
                'varies="distance",\n    ),\n',
            ),
            (
                "segmap/reduction/__init__.py",
                "from ._reduce_to",
                "from ._near_middle import near_middle\nfrom ._reduce_to",
            ),
            (
                "segmap/reduction/__init__.py",
                '"mean_shift", ',
                '"mean_shift", "near_middle",\n    ',
            ),
        ],
    ),
    "A new alignment method": (
        {
            "segmap/alignment/_worn_wheels.py": "worn_wheels",
            "tests/alignment/test_worn_wheels.py": "test_worn_wheels",
        },
        [
            (
                "segmap/alignment/__init__.py",
                "from .angle_correspondence",
                "from ._worn_wheels import worn_wheels\nfrom .angle_correspondence",
            ),
            (
                "segmap/alignment/__init__.py",
                '"usual_method",',
                '"usual_method",\n    "worn_wheels",',
            ),
            (
                "segmap/alignment/__init__.py",
                "Method[Alignment]] = {\n",
                "Method[Alignment]] = {\n"
                '    "worn_wheels": Method(worn_wheels, "ours", works="alone"),\n',
            ),
        ],
    ),
    "A new exercise": (
        {f"{EXERCISES}/wall_length.py": "wall_length"},
        [
            (
                COURSE,
                "from .panels import *",
                "from .exercises.wall_length import check_wall_length\nfrom .panels import *",
            ),
            (COURSE, '"check_weighed", ', '"check_wall_length",\n    "check_weighed", '),
            (
                "tests/right_answers.py",
                "RIGHT = {\n",
                'RIGHT = {\n    "wall_length": lambda s: math.dist(*s),\n',
            ),
        ],
    ),
    "A new chapter": (
        {f"{CHAPTER}.ipynb": "chapter"},
        [
            (
                "notebooks/SYLLABUS.md",
                "[50](50_which_map_is_best.ipynb), [51]",
                "[43](43_walls_by_hand.ipynb), [50](50_which_map_is_best.ipynb), [51]",
            )
        ],
    ),
}
#: What a recipe says to run before its tests.
TOOLS = {
    "A new chapter": (
        ["notebooks/tools/refresh.py", f"{CHAPTER}.ipynb"],
        ["notebooks/tools/minutes.py"],
    )
}


def notebook(text):
    """A notebook of cells that begin with `%% markdown` or `%% code`."""
    cells = []
    for cell in text.removeprefix("%% ").split("\n%% "):
        kind, source = cell.split("\n", 1)
        cells.append(getattr(nbformat.v4, f"new_{kind}_cell")(source.strip()))
    return nbformat.writes(nbformat.v4.new_notebook(cells=cells))


def recipe(heading):
    """The text of a recipe, and the arguments of the test command at its end."""
    section = CONTRIBUTING.split(f"## {heading}\n")[1].split("\n## ")[0]
    return section, re.search(r"`pytest ([^`]*)`", section).group(1)


@pytest.mark.slow
@pytest.mark.parametrize("heading", EXAMPLES)
def test_a_recipe_leads_to_a_change_that_its_tests_accept(heading, tmp_path):
    """Catches a step that the recipe forgets, and a test that knows the members of a family."""
    section, wanted = recipe(heading)
    listed = subprocess.run(
        ["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True
    )
    for name in filter(lambda name: (ROOT / name).is_file(), listed.stdout.splitlines()):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
    files, edits = EXAMPLES[heading]
    called = Path(next(iter(files))).stem.strip("_")
    for name, example in files.items():
        text = (WRITTEN / f"{example}.txt").read_text()
        (tmp_path / name).write_text(notebook(text) if name.endswith(".ipynb") else text)
    for name, before, after in edits:
        text = (tmp_path / name).read_text()
        assert text.count(before) == 1, (
            f"{name}: {before!r} stands there {text.count(before)} times"
        )
        (tmp_path / name).write_text(text.replace(before, after))
    said = section.replace("<family>", "carmen").replace("<format>", "paces")
    for name in {*files, *(name for name, _, _ in edits)}:
        step = said.replace("<name>", called).replace("<subject>", called)
        assert f"`{name}`" in step, f"no step names {name}"
    places = {"PYTHONPATH": f"{tmp_path}{os.pathsep}{tmp_path / 'notebooks'}"}
    lint, tools = ["-m", "ruff", "check", "--no-cache", *files], TOOLS.get(heading, ())
    tests = ["-m", "pytest", "-q", "-m", "not slow", "-p", "no:nbval", *wanted.split()]
    for command in (lint, *tools, tests if tools else [*tests, "-k", called]):
        ended = subprocess.run(
            [sys.executable, *command],
            cwd=tmp_path,
            env=os.environ | places,
            capture_output=True,
            text=True,
        )
        assert ended.returncode == 0, ended.stdout[-3000:] + ended.stderr[-2000:]
