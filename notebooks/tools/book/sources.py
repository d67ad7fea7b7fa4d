"""Copies of chapters and texts, adapted for the book; the originals stay as they are.

The copies lie as the originals do, so that links between them hold. In the copies, panels become
pictures of their states, headings get numbers, and chapters and theses that are named are linked.
"""

import html
import json
import re
import shutil
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import nbformat
from nbformat import NotebookNode

from segmap.readers._formats import names_of_formats

from . import new_form
from .alt_texts import stored_alt
from .citations import with_links
from .code_map import code_map

ROOT = Path(__file__).resolve().parents[3]
CHAPTERS = sorted((ROOT / "notebooks").glob("*.ipynb"))
PICTURES = ROOT / "notebooks" / "pictures" / "panels"
VIEW = "application/vnd.jupyter.widget-view+json"

#: Title of each part of the book -> the numbers of its chapters.
PARTS = {
    "Part 1: What a laser sees": range(1, 5),
    "Part 2: Where was the robot?": range(5, 12),
    "Part 3: How good is a map?": range(12, 14),
    "Part 4: Fewer segments": range(14, 24),
    "Part 5: Occupancy": range(24, 28),
    "Part 6: The building": range(28, 31),
    "Shelf": range(51, 91),
    "Appendix": range(91, 100),
}
#: Texts that become pages, and files that pages link; the rest of the project is not in the book.
TEXTS = ("*.md", "notebooks/*.md", "data/**/*.md")
FILES = (
    *("LICENSE", "CITATION.cff", "docs/pictures/*", "notebooks/pictures/*.png"),
    *("data/**/*.csv", "data/**/LICENSE"),
    *("notebooks/segmap_course/literal/**/*.py", "segmap/plan/*.py", "segmap/matching/*.py"),
)
#: Where a page of the docs gets the names of all formats.
FORMATS = "<!-- formats -->"
REFERENCE = (
    *("docs/one_command", "commands/index", "docs/logs_and_maps", "docs/which_method"),
    "api/index",
)
WHAT_HOLDS = ("docs/what_can_be_told", "docs/known_limits", "docs/references")
LINKED = re.compile(r"(`[^`\n]*`|\[[^\]]*\]\([^)]*\)|\$[^$]+\$|<[^>]+>)")
NAMED = re.compile(r"\b[Cc]hapters? \d\d(?:(?:,| and| to) \d\d)*\b(?!\.\d)")
HEADING = re.compile(r"^(##|###) (?=\S)", re.MULTILINE)
FENCED = re.compile(r"(^```.*?^```$|\$\$.*?\$\$)", re.MULTILINE | re.DOTALL)


@dataclass(frozen=True)
class Chapter:
    """A chapter as the book shows it, and what is wrong with it."""

    notebook: NotebookNode
    complaints: list[str]


def part_of(chapter: str) -> str:
    """Title of the part to which a chapter belongs, by the first two digits of its name."""
    return next(part for part, numbers in PARTS.items() if int(chapter[:2]) in numbers)


def number_of(path: Path) -> str:
    """Number of a chapter, of two digits."""
    return path.stem.partition("_")[0]


def copy_sources(folder: Path, chapters: list[Path] = CHAPTERS) -> list[str]:
    """Write all sources but the API into a folder; answers what is wrong with the originals."""
    complaints: list[str] = []
    for pattern in (*TEXTS, *FILES):
        for path in ROOT.glob(pattern):
            _copy(path, folder / path.relative_to(ROOT))
    shutil.copy(Path(__file__).parent / "index.md", folder)
    (folder / "docs").mkdir(exist_ok=True)
    formats = f"All formats by their names: {', '.join(names_of_formats())}."
    for path in ROOT.glob("docs/*.md"):
        text = path.read_text(encoding="utf-8").replace(FORMATS, formats)
        (folder / "docs" / path.name).write_text(text, encoding="utf-8")
    (folder / "code_map.md").write_text(code_map(), encoding="utf-8")
    (folder / "_static" / "panels").mkdir(parents=True)
    for path in PICTURES.glob("*.webp"):
        shutil.copy(path, folder / "_static" / "panels")
    states = read_states()
    for path in chapters:
        complaints += _copy_chapter(path, folder / "notebooks" / path.name, states)
    _write_contents(folder, chapters)
    return complaints


def read_chapter(path: Path, states: dict[str, list[str]]) -> Chapter:
    """A chapter, adapted for the book.

    Raises
    ------
    ValueError
        Where the file is no notebook.
    """
    notebook = nbformat.read(path, as_version=4)
    complaints = [f"{path.name}: {text}" for text in _unsound(notebook)]
    section = [0, 0]
    notebook.cells = [c for c in notebook.cells if "guard" not in c.metadata.get("tags", [])]
    for cell in notebook.cells:
        if cell.cell_type == "markdown":
            cell.source = adapt(numbered(cell.source, number_of(path), section))
        elif cell.source.strip():
            cell.metadata["tags"] = [*cell.metadata.get("tags", []), "hide-input"]
            if alt := stored_alt(cell):
                cell.metadata["mystnb"] = {"image": {"alt": alt}}
    new_form.adapt_cells(notebook)
    complaints += _replace_panels(notebook, path.stem, states)
    return Chapter(notebook, complaints)


def adapt(text: str) -> str:
    """Markdown whose chapters and theses are linked."""
    parts = FENCED.split(text)
    parts[::2] = (_linked(part) for part in parts[::2])
    return "".join(parts)


def read_states() -> dict[str, list[str]]:
    """Name of each picture of a panel -> what each of its states says."""
    from panel_pictures import said_in

    return {path.stem: said_in(path) for path in PICTURES.glob("*.webp")}


def write_stub(folder: Path, page: str, said: str) -> None:
    """In the place of a page that cannot be made, one that says so."""
    for old in folder.glob(f"{page}.*"):
        old.unlink()
    name = Path(page).name.replace("_", " ")
    text = f"# {name}\n\nThis page could not be made:\n\n```text\n{said}\n```\n"
    (folder / f"{page}.md").write_text(text, encoding="utf-8")


def _copy(path: Path, target: Path) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    if path.suffix == ".md":
        target.write_text(adapt(path.read_text(encoding="utf-8")), encoding="utf-8")
    else:
        shutil.copy(path, target)


def _copy_chapter(path: Path, target: Path, states: dict[str, list[str]]) -> list[str]:
    target.parent.mkdir(parents=True, exist_ok=True)
    try:
        chapter = read_chapter(path, states)
        nbformat.write(chapter.notebook, target)
    except Exception as problem:  # whatever a damaged file makes the reader say
        said = f"{type(problem).__name__}: {problem}"[:500]
        write_stub(target.parents[1], f"notebooks/{path.stem}", said)
        return [f"{path.name}: {said}"]
    return chapter.complaints


def _unsound(notebook: NotebookNode) -> list[str]:
    """What a reader of the stored outputs would miss."""
    code = [c for c in notebook.cells if c.cell_type == "code" and c.source.strip()]
    found = [o for c in code for o in c.outputs if o.output_type == "error"]
    errors = [f"a stored output is an error, {output.ename}" for output in found]
    bare = [] if all(c.execution_count for c in code) else ["some cells were not run: make refresh"]
    return errors + bare


def write_summaries(folder: Path) -> None:
    """A script with one sentence for each page, which the search shows below the name of a page."""
    said = {}
    for path in sorted((folder / "notebooks").glob("*.ipynb")):
        notebook = nbformat.read(path, as_version=4)
        first = notebook.cells[0].source
        claim = new_form.claim(notebook) or first.partition("\n\n")[2].partition("\n\n")[0]
        said[f"notebooks/{path.stem}"] = re.sub(r"\[([^]]*)\]\([^)]*\)|[*`$\\]", r"\1", claim)
    for path in (folder / "api").glob("*.rst"):
        said[f"api/{path.stem}"] = f"API: every public name of {path.stem}"
    for path in (folder / "commands").glob("*.rst"):
        said[f"commands/{path.stem}"] = f"Command: every option of segmap {path.stem}"
    text = f"const SUMMARIES = {json.dumps(said)};\n"
    (folder / "_static" / "summaries.js").write_text(text, encoding="utf-8")


# ------------------------------------------------------------------ words


def numbered(text: str, chapter: str, section: list[int]) -> str:
    """Headings with the numbers of chapter and section; links to them do without."""

    def number(match: re.Match[str]) -> str:
        if match.group(1) == "##":
            section[:] = section[0] + 1, 0
            return f"## {chapter}.{section[0]} "
        section[1] += 1
        return f"### {chapter}.{section[0]}.{section[1]} "

    parts = FENCED.split(text)
    parts[::2] = (HEADING.sub(number, part) for part in parts[::2])
    return "".join(parts)


def _linked(text: str) -> str:
    files = {number_of(path): path.name for path in CHAPTERS}
    place = "/notebooks/"

    def chapter(match: re.Match[str]) -> str:
        number = match.group().rpartition(" ")[2]
        return f"[{match.group()}]({place}{files[number]})" if number in files else match.group()

    def name(part: str) -> str:
        part = with_links(part, lambda words, label: f"[{words}](#{label})")
        return NAMED.sub(lambda m: re.sub(r"(?:[Cc]hapter )?\d\d", chapter, m.group()), part)

    parts = LINKED.split(text)
    inside = [name(part) if k % 2 == 0 else part for k, part in enumerate(parts)]
    return "".join(inside)


# ------------------------------------------------------------------ panels


def _replace_panels(notebook: NotebookNode, stem: str, states: dict[str, list[str]]) -> list[str]:
    """Put the pictures of its states in the place of each panel."""
    complaints, number = [], 0
    for cell in notebook.cells:
        for output in cell.get("outputs", []):
            data = output.get("data", {})
            if data.pop(VIEW, None) is None:
                continue
            number += 1
            name, said = f"{stem}-{number}", data.get("text/plain", "")
            if name not in states:
                complaints.append(f"{stem}: no pictures of panel {number}: make panels")
                continue
            known = states[name]
            if said_by(said) not in known:
                complaints.append(f"{stem}: pictures of panel {number} are old: make panels")
            first = known.index(said_by(said)) if said_by(said) in known else 0
            output["data"] = NotebookNode({"text/html": strip(name, known, first)})
    return complaints


def said_by(text: str) -> str:
    """What a panel says of itself, without its name."""
    return text.removesuffix(")").partition("(")[2]


def strip(name: str, said: list[str], first: int) -> str:
    """One file holds all states, one below the other: a slider chooses the part that is shown."""
    width, height = _size(PICTURES / f"{name}.webp")
    words = html.escape(said[first])
    return (
        f'<div class="panel-states" data-said="{html.escape(json.dumps(said))}"><figure>'
        f'<img src="../_static/panels/{name}.webp" alt="{words}" '
        f'style="aspect-ratio: {width} / {height // len(said)}; '
        f'object-position: 0 {100 * first / max(1, len(said) - 1):.4g}%">'
        f'<input type="range" max="{len(said) - 1}" value="{first}" aria-label="state">'
        f'<figcaption aria-live="polite">{words}</figcaption></figure>'
        f"<p>In JupyterLab all controls move; here, {len(said)} states of the panel.</p></div>"
    )


def _size(path: Path) -> tuple[int, int]:
    from PIL import Image

    with Image.open(path) as image:
        return image.size


# ------------------------------------------------------------------ table of contents


def _write_contents(folder: Path, chapters: list[Path]) -> None:
    """The front page with the contents of the book."""
    trees = [
        _tree(part, [f"notebooks/{p.stem}" for p in chapters if part_of(p.stem) == part])
        for part in PARTS
        if any(part_of(p.stem) == part for p in chapters)
    ]
    own = sorted(f"notebooks/{p.stem}" for p in (folder / "notebooks").glob("*.md"))
    own = [
        page for page in own if page.removeprefix("notebooks/") not in {c.stem for c in chapters}
    ]
    data = sorted(str(p.relative_to(folder).with_suffix("")) for p in folder.glob("data/**/*.md"))
    texts = ["README", "environment", *data, "code_map"]
    texts += ["CONTRIBUTING", "docs/fresh_reader", "CHANGELOG"]
    trees += [_tree("For teachers", own)] if own else []
    trees += [
        _tree("Reference", REFERENCE),
        _tree("What holds", WHAT_HOLDS),
        _tree("The project", texts),
    ]
    with (folder / "index.md").open("a", encoding="utf-8") as index:
        index.write("\n".join(trees))


def _tree(caption: str, pages: Iterable[str]) -> str:
    listed = "\n".join("README </README>" if p == "README" else f"/{p}" for p in pages)
    return f"```{{toctree}}\n:caption: {caption}\n:maxdepth: 1\n:hidden:\n\n{listed}\n```\n"
