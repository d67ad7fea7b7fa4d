"""How long chapters take, written into SYLLABUS.md: `.venv/bin/python notebooks/tools/minutes.py`.

Words by the speed of a second-language reader of technical text, cells and answers at fixed
minutes. A table of these is an estimate to plan a lab with, and no measurement of students.
"""

import json
import re
import sys
from pathlib import Path
from typing import NamedTuple

NOTEBOOKS = Path(__file__).resolve().parents[1]
SYLLABUS = NOTEBOOKS / "SYLLABUS.md"
#: Words a minute; minutes for a cell of code with what it shows, for a panel to play with, for a
#: function to be written, for an open exercise (a prediction, a counter-example, an own log).
SPEED, CELL, PANEL, FUNCTION, OPEN = 120, 0.75, 5, 20, 15
#: A row that links to chapters, and ends with minutes.
ROW = re.compile(r"^(\|.*\d\d_\w+\.ipynb\).*\| )(\d+) \|$", re.MULTILINE)
BEGIN, END = "<!-- minutes: begin -->", "<!-- minutes: end -->"


class Chapter(NamedTuple):
    """What a chapter holds."""

    file: str
    title: str
    words: int
    cells: int
    panels: int
    functions: int
    open: int

    @property
    def reading(self) -> int:
        """Minutes for text, cells and panels, to five."""
        return fives(self.words / SPEED + CELL * self.cells + PANEL * self.panels)

    @property
    def writing(self) -> int:
        """Minutes for the functions to be written."""
        return FUNCTION * self.functions

    @property
    def together(self) -> int:
        """Minutes without the open exercises."""
        return self.reading + self.writing


def fives(minutes: float) -> int:
    """Minutes to the next five."""
    return 5 * round(minutes / 5)


def chapter(path: Path) -> Chapter:
    """Count what a chapter holds."""
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    text = "\n".join("".join(c["source"]) for c in cells if c["cell_type"] == "markdown")
    code = ["".join(c["source"]) for c in cells if c["cell_type"] == "code"]
    joined = "\n".join(code)
    return Chapter(
        path.name,
        text.splitlines()[0].removeprefix("# ").partition(":")[0],
        len(re.findall(r"[^\s|]*\w[^\s|]*", text)),
        len(code),
        len(re.findall(r"^\w+ = (?:\w+\.)?(?:\w+Panel|Workbench)\(", joined, re.MULTILINE)),
        len(re.findall(r"^course\.check_(?!own_log)\w+\(", joined, re.MULTILINE)),
        len(re.findall(r"^course\.(?:predict_|break_|check_own_log)\w*\(", joined, re.MULTILINE)),
    )


def all_chapters() -> list[Chapter]:
    """Every chapter, in order."""
    return [chapter(path) for path in sorted(NOTEBOOKS.glob("[0-9][0-9]_*.ipynb"))]


def table(chapters: list[Chapter]) -> str:
    """The table of the syllabus."""
    names = ("chapter", "words", "cells", "read and run", "functions", "open", "minutes")
    head = f"| {' | '.join(names)} |\n|---|{'--:|' * 6}"
    rows = [
        f"| [{c.title}]({c.file}) | {c.words} | {c.cells} | {c.reading} | {c.writing} "
        f"| {OPEN * c.open} | {c.together} |"
        for c in chapters
    ]
    total = sum(chapter.together for chapter in chapters) / 60
    return "\n".join([head, *rows, f"\nAll chapters: {total:.0f} hours without open exercises."])


def written(text: str, chapters: list[Chapter]) -> str:
    """The syllabus with a fresh table, and with the sums of the paths."""
    minutes = {chapter.file: chapter.together for chapter in chapters}

    def summed(row: re.Match[str]) -> str:
        return f"{row.group(1)}{sum(minutes[file] for file in files(row.group(1)))} |"

    before, rest = text.split(BEGIN)
    after = ROW.sub(summed, rest.split(END)[1])
    return f"{before}{BEGIN}\n{table(chapters)}\n{END}{after}"


def files(row: str) -> list[str]:
    """The chapters that a row of a table links to."""
    return re.findall(r"\((\d\d_\w+\.ipynb)\)", row)


def stated(text: str) -> list[tuple[list[str], int]]:
    """The chapters of each row, and the minutes that it states."""
    return [(files(row), int(minutes)) for row, minutes in ROW.findall(text)]


def main() -> int:
    """Write the table anew."""
    before = SYLLABUS.read_text(encoding="utf-8")
    after = written(before, all_chapters())
    SYLLABUS.write_text(after, encoding="utf-8")
    print("stored anew" if after != before else "unchanged")
    return 0


if __name__ == "__main__":
    sys.exit(main())
