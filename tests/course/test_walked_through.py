"""Each method of the project is walked through in a chapter: section, source, panel, exercise.

The table `walked_through.csv` says where; the tests hold it against the chapters. A method that a
user registers needs no chapter.
"""

import csv
import json
import re
from functools import cache
from pathlib import Path

import pytest
import segmap_course as course
from chapter_rules import CHAPTERS, code_cells, markdown

from segmap import alignment, extraction, matching, reduction

#: Where a method is walked through. `section` begins a heading, `source` is a function that is
#: printed from `literal` or written there, `panel` a class of the course with the `controls` of the
#: method, `exercise` a check. One panel and one exercise may serve the methods of one mechanism.
with Path(__file__).with_name("walked_through.csv").open(encoding="utf-8", newline="") as _file:
    WALKED = {row.pop("method"): row for row in csv.DictReader(_file)}
#: These have a section and nothing else: there is nothing to choose.
SECTIONS = {"odometry": ("02", "Steps in a chain"), "ground_truth": ("02", "Poses between")}


@cache
def chapter(number: str) -> dict:
    (path,) = [path for path in CHAPTERS if path.name.startswith(f"{number}_")]
    return json.loads(path.read_text(encoding="utf-8"))


def headings(number: str) -> list[str]:
    return re.findall(r"^#+ (.+)$", markdown(chapter(number)), re.MULTILINE)


def code(number: str) -> str:
    return "\n".join(source for _, source, _ in code_cells(chapter(number)))


def test_every_method_of_the_project_is_in_the_table():
    """Catches a new method without a chapter."""
    names = [*alignment.METHODS, *reduction.METHODS, *matching.MATCHERS, *extraction.METHODS]
    assert sorted([*WALKED, *SECTIONS]) == sorted(names)
    assert all(all(row.values()) for row in WALKED.values()), "a hole"


@pytest.mark.parametrize("name", [*WALKED, *SECTIONS])
def test_a_method_is_walked_through(name):
    """Catches a method that is called and not shown, and a panel without what it is about."""
    row = WALKED.get(name, {})
    number, section = SECTIONS.get(name) or (row["chapter"], row["section"])
    assert any(heading.startswith(section) for heading in headings(number)), headings(number)
    if row:
        text = code(number)
        printed = rf"getsource\((?:\w+\.)*{row['source']}\)|^def {row['source']}\("
        assert re.search(printed, text, re.MULTILINE)
        assert f"course.{row['panel']}(" in text and f"course.check_{row['exercise']}(" in text
        parts = {n for kind in getattr(course, row["panel"]).__mro__ for n in vars(kind)}
        assert set(row["controls"].split()) <= parts
