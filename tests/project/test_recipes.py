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
#: Headings. The example of "A new reader", files that are written and what becomes of lines of
#: others, is `tests/recipes/reader.txt`.
RECIPES = ("reader", "reduction method", "alignment method", "exercise", "chapter")
#: What a recipe says to run before its tests.
TOOLS = {"chapter": ("notebooks/tools/refresh.py", "notebooks/tools/minutes.py")}


def notebook(text):
    """A notebook of cells that begin with `%% markdown` or `%% code`."""
    cells = []
    for cell in text.removeprefix("%% ").split("\n%% "):
        kind, source = cell.split("\n", 1)
        cells.append(getattr(nbformat.v4, f"new_{kind}_cell")(source.strip()))
    return nbformat.writes(nbformat.v4.new_notebook(cells=cells))


def example(heading):
    """Texts of new files, by name; and (file, what stands there, what it becomes)."""
    files, edits = {}, []
    parts = f"\n{(WRITTEN / f'{heading.split()[0]}.txt').read_text()}".split("\n=== ")[1:]
    named = [part.partition("\n")[::2] for part in parts]
    for (name, text), (after, new) in zip(named, [*named[1:], ("", "")], strict=True):
        if after == "becomes":
            edits.append((name, text.rstrip("\n"), new.rstrip("\n")))
        elif name != "becomes":
            files[name] = f"{text}\n"
    return files, edits


def recipe(heading):
    """The text of a recipe, and the arguments of the test command at its end."""
    section = CONTRIBUTING.split(f"## A new {heading}\n")[1].split("\n## ")[0]
    return section, re.search(r"`pytest ([^`]*)`", section).group(1)


@pytest.mark.slow
@pytest.mark.parametrize("heading", RECIPES)
def test_a_recipe_leads_to_a_change_that_its_tests_accept(heading, tmp_path):
    """Catches a step that the recipe forgets, and a test that knows the members of a family."""
    section, wanted = recipe(heading)
    listed = subprocess.run(
        ["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True
    )
    for name in filter(lambda name: (ROOT / name).is_file(), listed.stdout.splitlines()):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
    files, edits = example(heading)
    called = Path(next(iter(files))).stem.strip("_")
    for name, text in files.items():
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
    tools = [[tool, *files] if "refresh" in tool else [tool] for tool in tools]
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
