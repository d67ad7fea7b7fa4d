"""Slides of chapters, from their own words and stored outputs: `make slides`.

Each section has its heading, its first sentence, and a slide for each figure with the sentence that
leads to it. Of code only the methods are shown that the chapter prints. A file holds all that it
needs: it opens offline in a browser, where the arrow keys turn, and prints a slide a page.
"""

import html
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import nbformat
from book.alt_texts import stored_alt
from book.extension import formula
from book.sources import CHAPTERS
from markdown_it import MarkdownIt
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
PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>{title}</title><style>
html {{ scroll-snap-type: y mandatory; font: clamp(16px, 2.4vw, 30px)/1.4 sans-serif }}
body {{ margin: 0; color: #222 }}
section {{ box-sizing: border-box; height: 100vh; padding: 2.5vh 5vw; scroll-snap-align: start;
  display: flex; flex-direction: column; break-after: page; overflow: hidden }}
h1, h2, p {{ margin: 0 0 .5em }} h2 {{ font-size: 1.2em; color: #08519c }}
section.title {{ justify-content: center }}
img {{ flex: 1; min-height: 0; max-width: 100%; object-fit: contain }}
pre {{ flex: 1; min-height: 0; overflow: auto; font-size: .6em; background: #f5f5f5;
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
    """A heading, sentences in Markdown, and below them HTML: a figure, a method or nothing."""

    heading: str
    sentences: tuple[str, ...]
    shown: str = ""


def slides(notebook: NotebookNode) -> Iterator[Slide]:
    """The slides of a chapter, the first with its title and its claim."""
    heading, idea, lead, used, part = "", "", "", True, ""
    for cell in notebook.cells:
        for part in HEADINGS.split(cell.source) if cell.cell_type == "markdown" else []:
            if title := HEADING.match(part):
                if not used and idea:
                    yield Slide(heading, (idea,))
                heading, idea, lead, used = title[1], "", "", False
            lead = first_sentence(part) or lead
            idea = idea or lead
            if part.startswith("# "):  # the chapter's own slide has no figure
                yield Slide(heading, (idea,))
                used = True
        for shown in pictures(cell) if cell.cell_type == "code" else []:
            yield Slide(heading, (lead,) if used else tuple(dict.fromkeys((idea, lead))), shown)
            used = True
    if not used and idea:
        points = re.findall(r"^- (.+)$", part, re.MULTILINE) if heading == "Summary" else []
        yield Slide(heading, tuple(points) or (idea,))


def first_sentence(source: str) -> str:
    """The first sentence of the first paragraph, and the next where it is short or asks; or "".

    Examples
    --------
    >>> first_sentence("## Steps\\n\\n**Two, in turn. Then stop.** No more.\\n")
    '**Two, in turn. Then stop.** No more.'
    """
    paragraphs = [p for p in re.split(r"\n\s*\n", source) if not re.match(r"\s*([#|>-]|\$\$)", p)]
    sentence = ""
    for part in END.split(" ".join(paragraphs[0].split())) if paragraphs else []:
        sentence = f"{sentence} {part}".strip()
        whole = not any(sentence.count(mark) % 2 for mark in ("**", "$", "`"))
        if whole and not part.endswith("?") and len(sentence) > LEAST:
            break
    return sentence


def pictures(cell: NotebookNode) -> Iterator[str]:
    """What of a cell's outputs a slide shows: figures, panels as they begin, printed methods."""
    for output in cell.outputs:
        if png := output.get("data", {}).get("image/png"):
            alt = html.escape(stored_alt(cell))
            yield f'<img alt="{alt}" src="data:image/png;base64,{"".join(png.split())}">'
        if output.output_type == "stream" and "getsource(" in cell.source:
            yield f"<pre>{html.escape(output.text)}</pre>"


def as_html(sentence: str) -> str:
    """A sentence of Markdown as HTML, without its links, its formulas as MathML."""
    formulas = MATH.findall(sentence)
    found = MarkdownIt().renderInline(MATH.sub("\ue000", LINK.sub(r"\1", sentence)))
    return re.sub("\ue000", lambda _: formula(formulas.pop(0)), found)


def page(path: Path) -> str:
    """The slides of a chapter in one HTML page."""
    found = list(slides(nbformat.read(path, as_version=4)))
    parts = []
    for number, (heading, sentences, shown) in enumerate(found):
        kind, level = ("title", "h1") if number == 0 else ("", "h2")
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
