"""The syllabus names every chapter and exercise where it stands, and minutes that are not old."""

import re

import minutes
from chapter_rules import CHAPTERS, ROOT
from programs import program

parser = program("segmap_course", "parser")

TEXT = minutes.SYLLABUS.read_text(encoding="utf-8")
INSTRUCTOR = (ROOT / "notebooks/INSTRUCTOR.md").read_text(encoding="utf-8")
README = (ROOT / "README.md").read_text(encoding="utf-8")
KNOWN = {chapter.file: chapter for chapter in minutes.all_chapters()}


def test_minutes_are_those_of_the_chapters():
    """Catches a chapter that has grown. `notebooks/tools/minutes.py` counts anew."""
    rows = minutes.stated(TEXT)
    assert len(rows) > 40
    for row, said in rows:
        now = minutes.minutes_of(row, KNOWN)
        assert abs(said - now) <= max(15, 0.25 * now), f"{row}: {said}, now {now}"


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
    semester = paths.split("## Path 3")[1].split("## Path 4")[0]
    names = [path.name for path in CHAPTERS]
    assert [file for file in minutes.files(table) if file in names] == names
    assert sorted(minutes.files(semester)) == names


def test_the_commands_of_the_pages_are_understood():
    """Catches a page that names an option which is gone."""
    found = re.findall(r"^ +python -m segmap_course (.+)$", TEXT + INSTRUCTOR, re.MULTILINE)
    assert len(found) >= 2
    for line in found:
        parser().parse_args(line.split())
