"""Each reference to a chapter names one that exists, by its own number and title."""

import json
import re
from itertools import chain

from chapter_rules import CHAPTERS, ROOT, lines_of

#: File -> number and title, as the first line of the chapter has them.
NAMES = {
    path.name: re.match(r"# (\w+) ([^:\n]*)", lines_of(cells[0]["source"])).groups()
    for path in CHAPTERS
    if (cells := json.loads(path.read_text(encoding="utf-8"))["cells"])
}
NUMBERS, TITLES = {number for number, _ in NAMES.values()}, {t.lower() for _, t in NAMES.values()}
LINK = re.compile(r'\[([^][]*)\]\((?:[\w./]*/)?(\d\w*\.ipynb)(?:#[^)\s]*)?(?: "([^"]*)")?\)')
NAMED = re.compile(r"\b[Cc]hapters?\s(?:# )?(\d\d(?:(?:,| and| or| to|, and) \d\d)*)\b(?![.\d])")
TEXTS = sorted(
    path
    for pattern in (
        "*.md",
        "docs/*.md",
        "data/**/*.md",
        "notebooks/*.md",
        "benchmarks/*.py",
        "notebooks/segmap_course/**/*.py",
        "notebooks/tools/**/*.*",
        "segmap/**/*.py",
        "segmap_app/**/*.py",
        "tests/course/*.py",
    )
    for path in ROOT.glob(pattern)
    if path.suffix in (".md", ".py") and path.name != "test_chapter_form.py"  # a made-up chapter
)


def wrong_references(text):
    """What a text says of chapters that is not so."""
    for words, file, label in LINK.findall(text):
        number, title = NAMES.get(file, ("", ""))
        said, rest = re.match(r"(?:[Cc]hapter )?(\d\d\b)? ?(.*)", words, re.DOTALL).groups()
        told = [rest.lower()] if said or rest.lower() in TITLES else []
        if (
            file not in NAMES
            or said not in (None, number)
            or not all(title.lower().startswith(each) for each in told)
            or label not in ("", title)
        ):
            yield f"[{words}]({file})"
    for number in chain(*(re.findall(r"\d\d", said) for said in NAMED.findall(text))):
        if number not in NUMBERS:
            yield f"chapter {number}"


def test_references_of_chapters_name_the_chapter_that_they_mean():
    """Catches a number or a title that an older course had, and a file that is moved alone."""
    assert [file for file, (number, _) in NAMES.items() if file.split("_")[0] != number] == []
    for path in CHAPTERS:
        cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
        text = "\n\n".join(lines_of(cell["source"]) for cell in cells)
        assert list(wrong_references(text)) == [], path.name


def test_references_of_other_texts_name_the_chapter_that_they_mean():
    """Catches a README, a docstring or a table that was left behind."""
    assert len(TEXTS) > 300
    for path in TEXTS:
        text = path.read_text(encoding="utf-8")
        assert list(wrong_references(text)) == [], path.relative_to(ROOT)
