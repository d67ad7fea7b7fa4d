"""What every chapter must hold, one function a rule: `rule(notebook) -> complaints`.

`test_notebooks.py` applies `RULES` to every chapter.
"""

import ast
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
CHAPTERS = sorted((ROOT / "notebooks").glob("*.ipynb"))


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


def parsed(notebook: dict) -> Iterator[tuple[int, ast.Module]]:
    """Each cell of code, without the lines that are for the notebook and not Python."""
    for number, source, _ in code_cells(notebook):
        yield number, ast.parse(re.sub(r"^\s*[%!].*$", "", source, flags=re.MULTILINE))


def links(text: str) -> list[str]:
    """Targets of the links and pictures of a Markdown text that lead to files."""
    found = re.findall(r"\]\(([^)\s]+)[^)]*\)", text)
    return [t.split("#")[0] for t in found if not re.match(r"https?:|mailto:|#", t)]


def links_resolve(notebook: dict, folder: Path = ROOT / "notebooks") -> list[str]:
    return [f"no {t}" for t in links(markdown(notebook)) if not (folder / t).exists()]


def tags_of(cell: dict) -> list[str]:
    return list(cell["metadata"].get("tags", []))


RULES = (executed_in_order, no_errors, links_resolve)
