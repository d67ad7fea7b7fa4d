"""The syllabus names every chapter and exercise where it stands, and minutes that are not old."""

import re
from pathlib import Path

import minutes
from chapter_rules import CHAPTERS, ROOT
from programs import program

parser = program("segmap_course", "parser")

TEXT = minutes.SYLLABUS.read_text(encoding="utf-8")
INSTRUCTOR = (ROOT / "notebooks/INSTRUCTOR.md").read_text(encoding="utf-8")
KNOWN = {chapter.file: chapter for chapter in minutes.all_chapters()}


def test_minutes_are_those_of_the_chapters():
    """Catches a chapter that has grown. `notebooks/tools/minutes.py` counts anew."""
    rows = minutes.stated(TEXT)
    assert len(rows) > 40
    for files, said in rows:
        now = sum(KNOWN[file].together for file in files)
        assert abs(said - now) <= max(15, 0.25 * now), f"{files}: {said}, now {now}"


def test_chapters_are_described_once():
    """Catches a list that says other than the chapter. `notebooks/tools/minutes.py` writes all."""
    assert len({chapter.shows for chapter in KNOWN.values()} - {""}) == len(CHAPTERS)
    for path, text in minutes.fresh().items():
        there = path.read_text(encoding="utf-8")
        if path == minutes.SYLLABUS:  # words are counted to a quarter, descriptions to the letter
            there, text = (re.sub(r"\d+", "", each) for each in (there, text))
        assert there == text, f"{path.name}: run notebooks/tools/minutes.py"


def test_every_chapter_is_in_the_table_and_in_the_semester():
    table, paths = TEXT.split(minutes.END)
    semester = paths.split("## Path 3")[1]
    names = [path.name for path in CHAPTERS]
    assert [file for file in minutes.files(table) if file in names] == names
    assert sorted(minutes.files(semester)) == names


def test_what_is_handed_in_is_asked_for_in_these_chapters():
    for row in re.findall(r"^\|.*_\w+\.ipynb\).*`.*\|$", TEXT.split(minutes.END)[1], re.MULTILINE):
        asked = "".join((ROOT / "notebooks" / file).read_text() for file in minutes.files(row))
        missing = [
            name for name in re.findall(r"`(\w+)`", row) if f"course.check_{name}(" not in asked
        ]
        assert missing == [], row


def test_one_lab_takes_ninety_minutes_and_a_semester_twelve_weeks():
    first = next(said for files, said in minutes.stated(TEXT.split("## Path 1")[1]))
    assert 75 <= first <= 105
    weeks = minutes.stated(TEXT.split("## Path 3")[1])
    assert len(weeks) == 12 and max(said for _, said in weeks) <= 300


def test_the_commands_of_the_pages_are_understood():
    """Catches a page that names an option which is gone."""
    found = re.findall(r"^ +python -m segmap_course (.+)$", TEXT + INSTRUCTOR, re.MULTILINE)
    assert len(found) >= 2
    for line in found:
        parser().parse_args(line.split())


def test_a_chapter_is_counted():
    start = KNOWN[CHAPTERS[0].name]
    assert start.title == "01 Start here" and start.functions == 1 and start.panels == 1
    assert 600 < start.words < 4000
    assert minutes.fives(12) == 10 and minutes.fives(13) == 15
    assert Path(minutes.SYLLABUS).name == "SYLLABUS.md"
