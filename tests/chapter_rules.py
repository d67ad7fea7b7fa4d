"""What every chapter must hold, one function a rule: `rule(notebook) -> complaints`.

`test_notebooks.py` applies `RULES` to every chapter; `tests/course/form/test_chapter_form.py` has
those of the form that asks for a prediction.
"""

import ast
import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
CHAPTERS = sorted((ROOT / "notebooks").glob("*.ipynb"))

MOST_BYTES, MOST_LINES = 200_000, 15
#: Cells that hold the text to what it says, folded; what a reader checks by hand is not among them.
GUARD = "guard"


def lines_of(text: Any) -> str:
    """A notebook stores text as one string or as a list of lines."""
    return "".join(text) if isinstance(text, list) else str(text)


def code_cells(notebook: dict) -> Iterator[tuple[int, str, dict]]:
    for number, cell in enumerate(notebook["cells"]):
        if cell["cell_type"] == "code" and lines_of(cell["source"]).strip():
            yield number, lines_of(cell["source"]), cell


def markdown(notebook: dict) -> str:
    cells = (c for c in notebook["cells"] if c["cell_type"] == "markdown")
    return "\n\n".join(lines_of(cell["source"]) for cell in cells)


def outputs(notebook: dict) -> Iterator[tuple[int, dict]]:
    for number, _, cell in code_cells(notebook):
        yield from ((number, output) for output in cell.get("outputs", []))


def executed_in_order(notebook: dict) -> list[str]:
    """A cell that was not run passes nbval whatever it does."""
    found = [cell.get("execution_count") for _, _, cell in code_cells(notebook)]
    if found == list(range(1, len(found) + 1)) and found:
        return []
    return [f"cells were executed as {found}: run make refresh"]


def no_errors(notebook: dict) -> list[str]:
    return [
        f"cell {number}: {output.get('ename') or 'writes to standard error'}"
        for number, output in outputs(notebook)
        if output["output_type"] == "error" or output.get("name") == "stderr"
    ]


def small(notebook: dict) -> list[str]:
    size = len(json.dumps(notebook, indent=1, ensure_ascii=False).encode())
    return [f"{size} bytes, more than {MOST_BYTES}"] if size > MOST_BYTES else []


def is_guard(cell: dict) -> bool:
    return GUARD in cell["metadata"].get("tags", [])


def parsed(notebook: dict) -> Iterator[tuple[int, ast.Module]]:
    """Each cell of code, without the lines that are for the notebook and not Python."""
    for number, source, _ in code_cells(notebook):
        yield number, ast.parse(re.sub(r"^\s*[%!].*$", "", source, flags=re.MULTILINE))


def short_cells(notebook: dict) -> list[str]:
    return [
        f"cell {number}: {count} lines"
        for number, source, _ in code_cells(notebook)
        if (count := sum(bool(line.strip()) for line in source.splitlines())) > MOST_LINES
    ]


def links(text: str) -> list[str]:
    """Targets of the links and pictures of a Markdown text that lead to files."""
    found = re.findall(r"\]\(([^)\s]+)[^)]*\)", text)
    return [t.split("#")[0] for t in found if not re.match(r"https?:|mailto:|#", t)]


def links_resolve(notebook: dict, folder: Path = ROOT / "notebooks") -> list[str]:
    return [f"no {t}" for t in links(markdown(notebook)) if not (folder / t).exists()]


#: Chapters in the new form ask for a prediction; `tests/course/form` has rules of their own for
#: them.
NEW_FORM_TAG = "predict"


def tags_of(cell: dict) -> list[str]:
    return list(cell["metadata"].get("tags", []))


def in_the_new_form(notebook: dict) -> bool:
    return any(NEW_FORM_TAG in tags_of(cell) for cell in notebook["cells"])


RULES = (executed_in_order, no_errors, small, short_cells, links_resolve)
