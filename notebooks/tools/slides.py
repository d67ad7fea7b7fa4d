"""Slides of chapters, from their own words and stored outputs: `make slides`.

A slide for each figure, with the sentence that leads to it; one for each derivation, with its
formulas. A section with neither shows its table, what it printed, or its method, else it has no
slide: none is only a heading. Of tasks only figures are shown. A file holds all that it needs: it
opens offline in a browser, where the arrow keys turn, and prints a slide a page.
"""

import html
import re
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

import nbformat
from book.alt_texts import stored_alt
from book.extension import formula
from book.sources import CHAPTERS
from markdown_it import MarkdownIt
from minutes import SHOWS
from nbformat import NotebookNode

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "build" / "slides"
HEADING, HEADINGS = re.compile(r"#+ (.+)"), re.compile(r"^(?=#+ )", re.MULTILINE)
#: A sentence ends where the next begins, and where the text ends.
END = re.compile(r"(?<=[.!?])\s+(?=[A-Z*`$\[(])")
#: A sentence that is no longer than this says too little alone, characters.
LEAST = 30
LINK = re.compile(r"!?\[([^\]]*)\]\([^)]*\)")
MATH = re.compile(r"\$([^$]+)\$")
GAP = re.compile(r"\\q?quad")
DISPLAYED = re.compile(r"\$\$(.+?)\$\$", re.DOTALL)
BOLD, TABLE = re.compile(r"\*\*[^*]+\*\*"), re.compile(r"(?:^\|.*\n?)+", re.MULTILINE)
#: A cell that defines a method, and no stub of an answer; so many lines fit below a heading.
METHOD, MOST_LINES, MOST_ROWS = re.compile(r"(?:@.*\n)*(?:def|class) (?!my_)"), 20, 9
#: Of longer text the letters are smaller, so that it fits.
MOST_LETTERS = 550
#: Sections that ask for work, and cells that hold a text to what it says.
TASK = re.compile(r"Exercise|Predict|Decide|Break it|Open exercise|Own log|A log of your own")
GUARD = "guard"
#: What of a summary is no point of it.
NEXT = re.compile(r"Next|Onward|Back:")
PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>{title}</title><style>
html {{ scroll-snap-type: y mandatory; font: clamp(16px, 2.4vw, 30px)/1.4 sans-serif }}
body {{ margin: 0; color: #222 }}
section {{ box-sizing: border-box; height: 100vh; padding: 2.5vh 5vw; scroll-snap-align: start;
  display: flex; flex-direction: column; break-after: page; overflow: hidden }}
h1, h2, p {{ margin: 0 0 .5em }} h2 {{ font-size: 1.2em; color: #08519c }}
section.dense {{ font-size: .7em }}
section.title {{ justify-content: center }}
img {{ flex: 1; min-height: 0; max-width: 100%; object-fit: contain }}
math[display="block"] {{ font-size: 1.2em; margin: .5em auto }}
table {{ font-size: .7em; border-collapse: collapse }} td, th {{ padding: .2em .6em;
  text-align: left; border-bottom: 1px solid #ccc }}
pre {{ min-height: 0; overflow: auto; font-size: .75em; background: #f5f5f5;
  padding: .7em }}
</style></head><body>
{slides}
<script>
addEventListener("keydown", (event) => {{
  const step = {{ArrowRight: 1, ArrowLeft: -1}}[event.key];
  if (step) scrollBy({{top: step * innerHeight}});
}});
</script></body></html>
"""


class Slide(NamedTuple):
    """A heading, sentences in Markdown, and below them HTML: what there is to see."""

    heading: str
    sentences: tuple[str, ...]
    shown: str = ""


class Section:
    """What is read of a section: its idea, the sentence read last, and what no figure shows."""

    def __init__(self, heading: str = "") -> None:
        self.heading, self.idea, self.lead, self.text, self.used = heading, "", "", "", False
        self.printed: list[str] = []
        self.method = ""

    def read(self, part: str) -> None:
        """Go on with a part of its text."""
        self.lead = first_sentence(part) or self.lead
        self.idea = self.idea or self.lead
        self.text += f"\n\n{part}"

    def run(self, cell: NotebookNode) -> None:
        """Go on with a cell of code: its numbers, and a method where it defines one."""
        numbers = [output.text for output in cell.outputs if output.output_type == "stream"]
        if GUARD not in cell.metadata.get("tags", []):
            self.printed += [text for text in numbers if text.count("\n") <= MOST_LINES]
        if METHOD.match(cell.source) and cell.source.count("\n") < MOST_LINES:
            self.method = self.method or cell.source

    def slide(self, shown: str, lead: str = "") -> Slide:
        """The next slide; the first of a section tells its idea, too."""
        lead = lead or self.lead
        said = (lead,) if self.used else tuple(dict.fromkeys((self.idea, lead)))
        self.used = True
        return Slide(self.heading, said, shown)

    def last(self) -> Iterator[Slide]:
        """The slide of a section without one: points, a table, numbers or a method; or none."""
        if shows := SHOWS.search(self.text):  # the title of a chapter
            if not self.used:
                yield Slide(self.heading, (self.idea, f"{shows[1]}."))
        elif self.heading == "Summary":
            yield Slide(self.heading, points(self.text))
        elif not self.used and not TASK.match(self.heading):
            tables = [text for text in TABLE.findall(self.text) if text.count("\n") <= MOST_ROWS]
            shown = [as_table(table) for table in tables]
            shown += [preformatted(text) for text in (*self.printed, self.method) if text]
            if shown:
                yield Slide(self.heading, (self.idea,), shown[0])


def slides(notebook: NotebookNode) -> Iterator[Slide]:
    """The slides of a chapter, the first with its title, its question and its first picture.

    What is to be predicted stands there too. A section without anything to see has no slide.
    """
    found: list[Slide] = []
    section = Section()
    for cell in notebook.cells:
        for part in HEADINGS.split(cell.source) if cell.cell_type == "markdown" else []:
            if title := HEADING.match(part):
                found += section.last()
                section = Section(title[1])
            section.read(part)
            if asked := BOLD.findall(part) if section.heading == "Predict" else []:
                found[0] = found[0]._replace(sentences=(*found[0].sentences, asked[-1]))
            if derived := DISPLAYED.findall(part):
                shown = "".join(formula(line, "block") for line in lines_of(derived))
                *_, lead = ("", *whole_sentences(part.partition("$$")[0]))
                found.append(section.slide(shown, lead))
        if cell.cell_type == "code":
            found += [section.slide(shown) for shown in pictures(cell)]
            section.run(cell)
    yield from (*found, *section.last())


def lines_of(formulas: list[str]) -> list[str]:
    """Formulas, each a line: those that stand side by side are too wide for a slide.

    Examples
    --------
    >>> lines_of([r"a = b, \\qquad c = d", r"\\begin{pmatrix} a \\quad b \\end{pmatrix}"])
    ['a = b,', 'c = d', '\\\\begin{pmatrix} a \\\\quad b \\\\end{pmatrix}']
    """
    lines = [[body] if r"\begin" in body else GAP.split(body) for body in formulas]
    return [line.strip() for body in lines for line in body]


def whole_sentences(source: str) -> Iterator[str]:
    """Each sentence of the paragraphs of a text, cut in no bold text, code or formula."""
    for paragraph in re.split(r"\n\s*\n", source):
        sentence = ""
        if not re.match(r"\s*([#|>-]|\$\$)", paragraph):
            for part in END.split(" ".join(paragraph.split())):
                sentence = f"{sentence} {part}".strip()
                if not any(sentence.count(mark) % 2 for mark in ("**", "$", "`")):
                    yield sentence
                    sentence = ""


def first_sentence(source: str) -> str:
    """The first sentence of the first paragraph, and the next where it is short or asks; or "".

    Examples
    --------
    >>> first_sentence("## Steps\\n\\n**Two, in turn. Then stop.** No more.\\n")
    '**Two, in turn. Then stop.** No more.'
    """
    paragraphs = [p for p in re.split(r"\n\s*\n", source) if not re.match(r"\s*([#|>-]|\$\$)", p)]
    sentence = ""
    for part in whole_sentences(paragraphs[0]) if paragraphs else []:
        sentence = f"{sentence} {part}".strip()
        if not part.endswith("?") and len(sentence) > LEAST:
            break
    return sentence


def points(summary: str) -> tuple[str, ...]:
    """What a summary says, point by point, without what is next."""
    listed = re.findall(r"^- (.+)$", summary, re.MULTILINE)
    return tuple(listed) or tuple(s for s in whole_sentences(summary) if not NEXT.match(s))


def pictures(cell: NotebookNode) -> Iterator[str]:
    """What of a cell's outputs a slide shows: figures, panels as they begin, printed methods."""
    for output in cell.outputs:
        if png := output.get("data", {}).get("image/png"):
            alt = html.escape(stored_alt(cell))
            yield f'<img alt="{alt}" src="data:image/png;base64,{"".join(png.split())}">'
        if output.output_type == "stream" and "getsource(" in cell.source:
            yield preformatted(output.text)


def preformatted(text: str) -> str:
    """Numbers or a method, in letters of one width."""
    return f"<pre>{html.escape(text.strip())}</pre>"


def as_html(sentence: str) -> str:
    """A sentence of Markdown as HTML, without its links, its formulas as MathML."""
    return rendered(sentence, MarkdownIt().renderInline)


def as_table(table: str) -> str:
    """A table of Markdown as HTML."""
    return rendered(table, MarkdownIt().enable("table").render)


def rendered(text: str, render: Callable[[str], str]) -> str:
    """A text as HTML, its links as words and its formulas as MathML."""
    formulas = MATH.findall(text)
    found = render(MATH.sub("\ue000", LINK.sub(r"\1", text)))
    return re.sub("\ue000", lambda _: formula(formulas.pop(0)), found)


def page(path: Path) -> str:
    """The slides of a chapter in one HTML page."""
    found = list(slides(nbformat.read(path, as_version=4)))
    parts = []
    for number, (heading, sentences, shown) in enumerate(found):
        kind, level = ("title", "h1") if number == 0 else ("", "h2")
        kind = "dense" if sum(map(len, sentences)) > MOST_LETTERS else kind
        said = "".join(f"<p>{as_html(sentence)}</p>" for sentence in sentences if sentence)
        head = f"<{level}>{as_html(heading)}</{level}>"
        parts.append(f'<section class="{kind}">{head}{said}{shown}</section>')
    return PAGE.format(title=html.escape(found[0].heading), slides="\n".join(parts))


def main(paths: list[str]) -> None:
    """Write the slides of some chapters, or of all."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    for path in map(Path, paths) if paths else CHAPTERS:
        (FOLDER / f"{path.stem}.html").write_text(page(path), encoding="utf-8")
    print(f"written: {FOLDER}")


if __name__ == "__main__":
    main(sys.argv[1:])
