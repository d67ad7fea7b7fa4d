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

import pytest

ROOT = Path(__file__).resolve().parents[2]
CONTRIBUTING = (ROOT / "CONTRIBUTING.md").read_text()
READERS, SAMPLES = "segmap/readers/carmen", "tests/log_samples.py"
EXERCISES, COURSE = "notebooks/segmap_course/exercises", "notebooks/segmap_course/__init__.py"

PACES = '''"""Logs of paces, an example: a scan a line, behind the robot's pose.

    PACE x y theta t n r1 ... rn

Metres, radians, seconds; the pose is that of the wheels.

Assumed: the beams follow the rule of `half_turn`, and the laser sits at the robot's centre.
"""

from __future__ import annotations

from .._lines import counted_fields, float_fields, pose_fields, time
from .._raw_scans import RawScan, half_turn, view_of
from .._text import TextFormat

PACE_SCAN = "PACE"


class Paces(TextFormat):
    """A log of paces."""

    name, keywords, expected = "Paces", (PACE_SCAN,), f"a {PACE_SCAN} line"

    def _take(self, fields: list[str]) -> None:
        if fields[0] != PACE_SCAN or len(fields) < 6:
            raise ValueError(f"expected a {PACE_SCAN} line, got {fields[0][:40]!r}")
        odometry, when = pose_fields(fields[1:4], "the odometry"), time(fields[4])
        words, rest = counted_fields(fields[5:], "ranges")
        if rest:
            raise ValueError(f"announces {len(words)} ranges, but {len(rest)} more follow")
        ranges, angles = float_fields(words, "ranges"), half_turn(len(words))
        view = (view_of(angles),)
        self.scans.append(RawScan(PACE_SCAN, ranges, angles, when, odometry, assumed=view))
'''

NEAR_MIDDLE = '''"""Near middles, an example: a segment takes in those whose middles are near."""

from __future__ import annotations

import numpy as np

from ..arrays import Array, Metres, Segments, checked
from ..compiled import compiled
from ._runner import Found, Indices, Reduction, Rows, run_offline


@checked
def near_middle(map: Segments, *, distance: Metres = 0.20) -> Reduction:
    """Let each segment be taken in by the first one whose middle is near its own.

    Parameters
    ----------
    map : SegmentMap, Reduction or (n, 2, 2) array
        Its scans are ignored.
    distance
        Middles nearer than this are of one wall: 0.20 m as in `basic_offline`.

    Returns
    -------
    Reduction
        In the order of the segments that took the others in, each as long as all of them together.

    Examples
    --------
    >>> near_middle([[(0, 0), (1, 0)], [(0, 0.1), (1, 0.1)], [(0, 1), (1, 1)]]).parents
    array([0, 0, 1])
    """

    def reduce(rows: Rows) -> Found:
        s = rows.segments
        first = _first_near(s.mean(1), distance)
        kept, into = np.unique(first, return_inverse=True)
        drawn = []
        for k, i in enumerate(kept):
            along = (s[i, 1] - s[i, 0]) / np.hypot(*(s[i, 1] - s[i, 0]))
            places = (s[into == k] - s[i, 0]) @ along
            drawn.append(s[i, 0] + np.outer([places.min(), places.max()], along))
        return np.array(drawn).reshape(-1, 2, 2), into

    return run_offline("near_middle", map, reduce)


@compiled
def _first_near(middles: Array, distance: float) -> Indices:
    first = np.arange(len(middles))
    for i in range(len(middles)):
        for k in range(i):
            x, y = middles[i, 0] - middles[k, 0], middles[i, 1] - middles[k, 1]
            if first[k] == k and x * x + y * y < distance * distance:
                first[i] = k
                break
    return first
'''

NEAR_MIDDLE_TEST = '''"""Near middles: what is near the first, and what is near the second only."""

from segmap.reduction import near_middle


def test_a_chain_is_cut_by_near_middle():
    """Catches a segment that is compared with one that was taken in."""
    walls = [[(0, y), (1, y)] for y in (0, 0.15, 0.3)]
    assert near_middle(walls).parents.tolist() == [0, 0, 1]


def test_parallel_walls_that_are_apart_stay_with_near_middle():
    """The map on which it fails as it must: a short wall beside the end of a long one stays."""
    assert len(near_middle([[(0, 0), (4, 0)], [(3, 0.01), (4, 0.01)]])) == 2
'''

WORN_WHEELS = '''"""Worn wheels, an example: the steps of the odometry, made longer."""

from __future__ import annotations

from ..arrays import Positive
from ..poses import compose
from ..scans import Log
from ._result import Outcome, Trail, alignment_method


@alignment_method
def worn_wheels(log: Log, *, factor: Positive = 1.0) -> Outcome:
    """Carry the odometry on, each step as many times as long as it says.

    Parameters
    ----------
    factor
        1 for wheels that are as large as the robot believes.

    Examples
    --------
    >>> from segmap import load
    >>> worn_wheels(load("room"), factor=1.01)
    Alignment(worn_wheels: 61 scans, 61 used)
    """
    trail = Trail(log)
    while len(trail.laid) < len(log):
        trail.place(compose(trail.pose(), trail.step() * (factor, factor, 1)))
    return Outcome(trail.laid)
'''

WORN_WHEELS_TEST = '''"""Worn wheels: a drive whose truth is known, and a factor that is none."""

import numpy as np
import pytest

from segmap import load
from segmap.alignment import worn_wheels


def test_steps_are_as_many_times_as_long_with_worn_wheels():
    """Catches a turn that is worn too."""
    log = load("room")
    one, two = worn_wheels(log).poses, worn_wheels(log, factor=2).poses
    np.testing.assert_allclose(two[:, 2], one[:, 2], atol=1e-9)
    np.testing.assert_allclose(two[:, :2] - two[0, :2], 2 * (one[:, :2] - one[0, :2]), atol=1e-9)


def test_a_log_whose_wheels_do_not_turn_is_refused_by_worn_wheels():
    with pytest.raises(ValueError, match="factor"):
        worn_wheels(load("room"), factor=0)
'''

WALL_LENGTH = '''"""An exercise on one segment, an example."""

from __future__ import annotations

import numpy as np

from segmap.segments import length

from ._answers import Cases
from ._exercise import Exercise, Rng


def _walls(rng: Rng) -> Cases:
    return {"a wall": (rng.uniform(1, 4, (2, 2)) * [[-1, 1], [1, 3]],)}


check_wall_length = Exercise(
    "wall_length(segment) -> its length, metres; segment (2, 2): two ends, metres",
    length,
    _walls,
    {
        "take the root of the sum of squares": lambda s: float(length(s) ** 2),
        "the way is straight: not along x and then along y": lambda s: float(
            np.abs(s[1] - s[0]).sum()
        ),
        "both coordinates count": lambda s: abs(s[1, 0] - s[0, 0]),
        "take the difference of the ends before its length": lambda s: float(
            np.hypot(*s[1]) - np.hypot(*s[0])
        ),
    },
    withheld=("length",),
)
'''

#: The recipe's heading -> files that are written, and (file, what stands there, what it becomes).
EXAMPLES = {
    "A new reader": (
        {f"{READERS}/_paces.py": PACES},
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
            "segmap/reduction/_near_middle.py": NEAR_MIDDLE,
            "tests/reduction/test_near_middle.py": NEAR_MIDDLE_TEST,
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
            "segmap/alignment/_worn_wheels.py": WORN_WHEELS,
            "tests/alignment/test_worn_wheels.py": WORN_WHEELS_TEST,
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
        {f"{EXERCISES}/wall_length.py": WALL_LENGTH},
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
}


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
    for name, text in files.items():
        (tmp_path / name).write_text(text)
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
    lint = [sys.executable, "-m", "ruff", "check", "--no-cache", *files]
    tests = [sys.executable, "-m", "pytest", "-q", "-m", "not slow", "-p", "no:nbval"]
    for command in (lint, [*tests, *wanted.split(), "-k", called]):
        ended = subprocess.run(
            command, cwd=tmp_path, env=os.environ | places, capture_output=True, text=True
        )
        assert ended.returncode == 0, ended.stdout[-3000:] + ended.stderr[-2000:]
