"""What chapters show and how long they take, as their own cells say, written into the syllabus and
the README by `.venv/bin/python notebooks/tools/minutes.py`.

Words and lines of code that are not folded by the speed of a second-language reader of technical
text, pictures, panels and answers at fixed minutes. A table of these is an estimate to plan a lab
with, and no measurement of students.
"""

import json
import re
import sys
from pathlib import Path
from typing import NamedTuple

from book.sources import PARTS, part_of

NOTEBOOKS = Path(__file__).resolve().parents[1]
SYLLABUS, README = NOTEBOOKS / "SYLLABUS.md", NOTEBOOKS.parent / "README.md"
#: Words and lines of code a minute.
SPEED, LINES = 120, 6
#: Minutes for a picture, for a panel or a figure to drag, for a function to be written, for an open
#: exercise (a prediction, a counter-example, an own log).
PICTURE, PANEL, FUNCTION, OPEN = 0.75, 5, 20, 15
#: What an output is called that is a picture, and one that moves.
IMAGE, WIDGET = "image/png", "application/vnd.jupyter.widget-view+json"
#: A row that links to chapters, and ends with minutes; and cells of a row of a lab, of which the
#: last but one names the functions that are written at home, which are no part of its minutes.
ROW = re.compile(r"^(\|.*\d\d_\w+\.ipynb\).*\| )(\d+) \|$", re.MULTILINE)
CELLS_OF_LAB = 5
BEGIN, END = "<!-- minutes: begin -->", "<!-- minutes: end -->"
#: The last line of the first cell of a chapter; and between which lines all of them are listed.
SHOWS = re.compile(r"^\*What it shows: (.*)\.\*$", re.MULTILINE)
LIST = re.compile(r"(?<=<!-- chapters: begin -->\n).*?(?=<!-- chapters: end -->)", re.DOTALL)


class Chapter(NamedTuple):
    """What a chapter holds."""

    file: str
    title: str
    shows: str
    words: int
    lines: int
    pictures: int
    panels: int
    functions: int
    open: int

    @property
    def reading(self) -> int:
        """Minutes for text, code, pictures and panels, to five."""
        text = self.words / SPEED + self.lines / LINES
        return fives(text + PICTURE * self.pictures + PANEL * self.panels)

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
    code = [c for c in cells if c["cell_type"] == "code"]
    joined = "\n".join("".join(c["source"]) for c in code)
    folded = [c["metadata"].get("jupyter", {}).get("source_hidden", False) for c in code]
    read = ["".join(c["source"]) for c, away in zip(code, folded, strict=True) if not away]
    shown = [output.get("data", {}) for c in code for output in c["outputs"]]
    panels = sum(WIDGET in kinds for kinds in shown)
    return Chapter(
        path.name,
        text.splitlines()[0].removeprefix("# ").partition(":")[0],
        "".join(SHOWS.findall("".join(cells[0]["source"]))),
        len(re.findall(r"[^\s|]*\w[^\s|]*", text)),
        len(re.findall(r"^[ ]*[^#\s]", "\n".join(read), re.MULTILINE)),
        sum(IMAGE in kinds for kinds in shown) - panels,
        panels,
        len(re.findall(r"^course\.check_(?!own_log)\w+\(", joined, re.MULTILINE)),
        len(
            re.findall(
                r"^course\.(?:predict_|break_|decide_|check_own_log)\w*\(", joined, re.MULTILINE
            )
        ),
    )


def all_chapters() -> list[Chapter]:
    """Every chapter, in order."""
    return [chapter(path) for path in sorted(NOTEBOOKS.glob("[0-9]*_*.ipynb"))]


def table(chapters: list[Chapter]) -> str:
    """The table of the syllabus."""
    names = ("chapter", "what it shows", "words", "lines", "read and run", "functions", "open")
    head = f"| {' | '.join(names)} | minutes |\n|---|---|{'--:|' * 6}"
    rows = [
        f"| [{c.title}]({c.file}) | {c.shows} | {c.words} | {c.lines} | {c.reading} | {c.writing} "
        f"| {OPEN * c.open} | {c.together} |"
        for c in chapters
    ]
    total = sum(chapter.together for chapter in chapters) / 60
    return "\n".join([head, *rows, f"\nAll chapters: {total:.0f} hours without open exercises."])


def written(text: str, chapters: list[Chapter]) -> str:
    """The syllabus with a fresh table, and with the sums of the paths."""
    known = {chapter.file: chapter for chapter in chapters}

    def summed(row: re.Match[str]) -> str:
        return f"{row.group(1)}{minutes_of(row.group(), known)} |"

    before, rest = text.split(BEGIN)
    after = ROW.sub(summed, rest.split(END)[1])
    return f"{before}{BEGIN}\n{table(chapters)}\n{END}{after}"


def minutes_of(row: str, known: dict[str, Chapter]) -> int:
    """Minutes of the chapters of a row, without the functions that are written at home."""
    cells = row.strip("| ").split(" | ")
    home = cells[3].count("`") // 2 if len(cells) == CELLS_OF_LAB else 0
    return sum(known[file].together for file in files(row)) - FUNCTION * home


def files(row: str) -> list[str]:
    """The chapters that a row of a table links to."""
    return re.findall(r"\((\d\d_\w+\.ipynb)\)", row)


def stated(text: str) -> list[tuple[str, int]]:
    """Each row that links to chapters, and the minutes that it states."""
    return [(row.group(), int(row.group(2))) for row in ROW.finditer(text)]


def listed(text: str, chapters: list[Chapter]) -> str:
    """A text beside the folder of the chapters, with a row of numbers for each part."""
    rows = ""
    for part in PARTS:
        own = [
            f'[{number}](notebooks/{c.file} "{title}")'
            for c in chapters
            for number, _, title in [c.title.partition(" ")]
            if part_of(c.file) == part
        ]
        rows += f"| {part} | {' '.join(own)} |\n"
    return LIST.sub(lambda _: f"| part | chapters |\n|---|---|\n{rows}", text)


def fresh() -> dict[Path, str]:
    """Each file that lists chapters, as it should be."""
    chapters = all_chapters()
    return {
        SYLLABUS: written(SYLLABUS.read_text(encoding="utf-8"), chapters),
        README: listed(README.read_text(encoding="utf-8"), chapters),
    }


def main() -> int:
    """Write all lists anew."""
    for path, after in fresh().items():
        before = path.read_text(encoding="utf-8")
        path.write_text(after, encoding="utf-8")
        print(f"{path.name}: {'stored anew' if after != before else 'unchanged'}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
