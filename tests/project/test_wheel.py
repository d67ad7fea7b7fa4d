"""The wheel holds the library, the course, chapters and data, each file once, and works alone."""

import subprocess
import sys
import zipfile
from collections import Counter
from pathlib import Path

import pytest
from makefile import ROOT

PATH_CODE = """
import segmap, segmap_app.files, segmap_course
from segmap.files import chapters_folder
for package in (segmap, segmap_app, segmap_course):
    print(package.__file__)
print(chapters_folder(), segmap.load("room"), sep="\\n")
"""


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    folder = tmp_path_factory.mktemp("wheel")
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)]
    subprocess.run(command, cwd=ROOT, check=True, capture_output=True)
    return zipfile.ZipFile(next(folder.glob("*.whl")))


def test_each_file_is_in_the_wheel_once(wheel):
    """Catches a course that is shipped twice, a folder that is forgotten, tools, and answers."""
    names = [name for name in wheel.namelist() if ".dist-info/" not in name]
    folders = [ROOT / name for name in ("segmap", "segmap_app", "notebooks/segmap_course")]
    sources = [path for folder in folders for path in folder.rglob("*.py")]
    here = [str(p.relative_to(ROOT)).removeprefix("notebooks/") for p in sources]
    answers = ("segmap_course/grading/", "segmap_course/__main__.py")
    here = [name for name in here if not name.startswith(answers)]
    code = [n for n in names if n.endswith(".py") and not n.startswith("segmap/data/")]
    assert Counter(code) == Counter(here)
    chapters = {f"segmap/notebooks/{p.name}" for p in (ROOT / "notebooks").glob("*.ipynb")}
    assert not {"segmap/notebooks/EXAM.md", "segmap/notebooks/INSTRUCTOR.md"} & set(names)
    assert chapters <= set(names) and "segmap/notebooks/pictures/malaga.png" in names
    tops = {name.split("/")[0] for name in names}
    assert max(Counter(names).values()) == 1 and tops == {"segmap", "segmap_app", "segmap_course"}
    assert {
        "segmap/py.typed",
        "segmap_app/py.typed",
        "segmap_course/py.typed",
        "segmap/data/room/room.log.gz",
    } <= set(names)


def test_the_wheel_works_away_from_the_clone(wheel, tmp_path):
    """Catches a file that is found beside the clone only."""
    wheel.extractall(tmp_path)
    environment = {"PYTHONPATH": str(tmp_path), "PATH": "/usr/bin:/bin"}
    run = [sys.executable, "-c", PATH_CODE]
    done = subprocess.run(run, cwd="/", env=environment, capture_output=True, text=True, check=True)
    *places, log = done.stdout.splitlines()
    assert all(Path(place).is_relative_to(tmp_path) for place in places) and log.startswith("Log(")
