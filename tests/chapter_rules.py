"""What every chapter must hold, one function a rule: `rule(notebook) -> complaints`.

`test_notebooks.py` applies `RULES` to every chapter, `OLD_FORM_RULES` to those in the older form,
and each to a notebook that breaks it. `tests/course/form/test_chapter_form.py` has those of the new
form.
"""

import ast
import base64
import builtins
import functools
import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import segmap_course
from matplotlib.axes import Axes

import segmap

ROOT = Path(__file__).resolve().parents[1]
CHAPTERS = sorted((ROOT / "notebooks").glob("*.ipynb"))

MOST_BYTES, MOST_PICTURE_BYTES, MOST_LINES = 200_000, 30_000, 15
#: Of a figure, at 72 dots an inch; and how many cells of code may follow each other without words.
LEAST_INCHES, MOST_WORDLESS = (5.0, 3.5), 4
#: Cells that hold the text to what it says, folded; what a reader checks by hand is not among them.
GUARD = "guard"
#: Where a node of Python's syntax holds the name that it binds.
BOUND = ("id", "arg", "asname", "name")
#: Lines of a cell that call matplotlib; what is longer is a drawing of the course. What its axes,
#: figures and pyplot are asked for, and nothing else has.
MOST_PLOTTING = 5
PLOTTING = {*dir(Axes), "subplots", "figure", "colorbar", "suptitle"} - {*dir(dict), *dir(set)}

#: What differs from machine to machine or from run to run: text of outputs must hold none of it.
UNSTEADY = {
    "an address in memory": r"\bat 0x[0-9a-fA-F]+|\b0x[0-9a-f]{8,}",
    "a path": r"(?<![\w.:/])/(?:home|root|usr|tmp|opt|mnt|var|Users|private|work)/|[A-Z]:\\\w",
    "a date": r"\b(?:19|20)\d\d-[01]\d-[0-3]\d\b|\b[0-3]?\d [A-Z][a-z]{2,8} 20\d\d\b|"
    r"\b(?:[01]\d|2[0-3]):[0-5]\d:[0-5]\d\b",
    "a duration": r"\b\d[\d.,]*\s*(?:ms|us|µs|ns|minutes?)\b|\b(?:took|in|elapsed:?) \d[\d.]* ?s\b|"
    r"\b(?:it|its)/s\b|per loop",
}
FORBIDDEN = {
    "a star import": r"^\s*from\s+\S+\s+import\s+\*",
    "an installation": r"\b(?:pip3?|conda|mamba|apt(?:-get)?)\b['\", ]+install|^\s*%pip|^\s*!",
    "a download": r"urlretrieve|urlopen|\brequests\.|\bwget\b|\bcurl\b|https?://",
}


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


def texts(output: dict) -> Iterator[str]:
    """Everything in an output that a reader reads."""
    yield lines_of(output.get("text", ""))
    for kind, data in output.get("data", {}).items():
        if kind.startswith("text/") or kind == "image/svg+xml":
            yield lines_of(data)


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


def no_widget_state(notebook: dict) -> list[str]:
    kept = [key for key in notebook["metadata"] if key not in ("kernelspec", "language_info")]
    return [f"metadata holds {key}: run make refresh" for key in kept]


def small(notebook: dict) -> list[str]:
    size = len(json.dumps(notebook, indent=1, ensure_ascii=False).encode())
    return [f"{size} bytes, more than {MOST_BYTES}"] if size > MOST_BYTES else []


def small_pictures(notebook: dict) -> list[str]:
    return [
        f"cell {number}: a picture of more than {MOST_PICTURE_BYTES} bytes"
        for number, output in outputs(notebook)
        if len(base64.b64decode(lines_of(output.get("data", {}).get("image/png", ""))))
        > MOST_PICTURE_BYTES
    ]


def large_figures(notebook: dict) -> list[str]:
    """Figures that can be read from the second row."""
    found = [
        (number, *(float(dots) / 72 + 0.01 for dots in match.groups()))
        for number, output in outputs(notebook)
        for text in texts(output)
        if (match := re.match(r"<Figure size ([\d.]+)x([\d.]+) ", text))
    ]
    small = [size for size in found if size[1] < LEAST_INCHES[0] or size[2] < LEAST_INCHES[1]]
    return [f"cell {number}: a figure of {w:.1f} x {h:.1f} inches" for number, w, h in small]


def words_between(notebook: dict) -> list[str]:
    seen = [cell for cell in notebook["cells"] if not is_guard(cell)]
    kinds = "".join("c" if cell["cell_type"] == "code" else "m" for cell in seen)
    longest = max(map(len, kinds.split("m")))
    return [f"{longest} cells of code without words"] if longest > MOST_WORDLESS else []


def is_guard(cell: dict) -> bool:
    return GUARD in cell["metadata"].get("tags", [])


def guards_are_folded(notebook: dict) -> list[str]:
    """A guard asserts, shows nothing, and JupyterLab opens it folded."""
    return [
        f"cell {number}: a guard that is not folded, shows something, or asserts nothing"
        for number, source, cell in code_cells(notebook)
        if is_guard(cell)
        and not (
            cell["metadata"].get("jupyter") == {"source_hidden": True}
            and not cell.get("outputs")
            and re.search(r"^\s*assert", source, re.MULTILINE)
        )
    ]


def assertions_in_sight(notebook: dict) -> int:
    """Lines of code that begin an assertion, in cells that are not folded."""
    return sum(
        line.lstrip().startswith("assert")
        for _, source, cell in code_cells(notebook)
        if not is_guard(cell)
        for line in source.splitlines()
    )


def steady_outputs(notebook: dict) -> list[str]:
    return [
        f"cell {number}: {what} in the output: {match.group()!r}"
        for number, output in outputs(notebook)
        for text in texts(output)
        for what, pattern in UNSTEADY.items()
        if (match := re.search(pattern, text))
    ]


def nothing_forbidden(notebook: dict) -> list[str]:
    return [
        f"cell {number}: {what}"
        for number, source, _ in code_cells(notebook)
        for what, pattern in FORBIDDEN.items()
        if re.search(pattern, source, re.MULTILINE)
    ]


def parsed(notebook: dict) -> Iterator[tuple[int, ast.Module]]:
    """Each cell of code, without the lines that are for the notebook and not Python."""
    for number, source, _ in code_cells(notebook):
        yield number, ast.parse(re.sub(r"^\s*[%!].*$", "", source, flags=re.MULTILINE))


def shadows_no_builtin(notebook: dict) -> list[str]:
    """Who copies a cell that binds `map` or `max` has lost Python's own."""
    bound = [
        (number, next(n for key in BOUND if (n := getattr(node, key, None))))
        for number, cell in parsed(notebook)
        for node in ast.walk(cell)
        if (isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store))
        or isinstance(node, ast.arg | ast.alias | ast.FunctionDef | ast.ClassDef)
    ]
    own = {*dir(builtins)} - {"_"}  # which a doctest before leaves there
    return [f"cell {number}: binds {name}" for number, name in bound if name in own]


def plotting_lines(part: ast.AST) -> set[int]:
    """Lines that call matplotlib, whole statements of them, and the heads of their loops."""
    statements = [node for node in ast.iter_child_nodes(part) if isinstance(node, ast.stmt)]
    lines = set().union(*map(plotting_lines, statements))
    if statements:
        return lines | {part.lineno} if lines and isinstance(part, ast.stmt) else lines
    calls = [node.func for node in ast.walk(part) if isinstance(node, ast.Call)]
    called = {call.attr for call in calls if isinstance(call, ast.Attribute)}
    return set(range(part.lineno, part.end_lineno + 1)) if called & PLOTTING else set()


def short_plotting(notebook: dict) -> list[str]:
    """A reader of a chapter came for its subject, and not for legends and ticks."""
    return [
        f"cell {number}: {len(lines)} lines of matplotlib"
        for number, cell in parsed(notebook)
        if len(lines := plotting_lines(cell)) > MOST_PLOTTING
    ]


def short_cells(notebook: dict) -> list[str]:
    return [
        f"cell {number}: {count} lines"
        for number, source, _ in code_cells(notebook)
        if (count := sum(bool(line.strip()) for line in source.splitlines())) > MOST_LINES
    ]


@functools.cache
def defined_in_segmap() -> set[str]:
    """Names that a reader can import from the rooms of the library and from the course."""
    rooms = [segmap, segmap_course, *(getattr(segmap, name) for name in segmap.__all__)]
    named = [pair for room in rooms for pair in getattr(room, "__dict__", {}).items()]
    return {name for name, value in named if name[0] != "_" and callable(value)}


def defines_nothing_twice(notebook: dict) -> list[str]:
    """A copy of the library's function in a chapter drifts away from it."""
    ours = defined_in_segmap()
    return [
        f"cell {number}: defines {name}, which segmap has"
        for number, source, _ in code_cells(notebook)
        for name in re.findall(r"^\s*(?:def|class)\s+(\w+)", source, re.MULTILINE)
        if name in ours
    ]


def links(text: str) -> list[str]:
    """Targets of the links and pictures of a Markdown text that lead to files."""
    found = re.findall(r"\]\(([^)\s]+)[^)]*\)", text)
    return [t.split("#")[0] for t in found if not re.match(r"https?:|mailto:|#", t)]


def links_resolve(notebook: dict, folder: Path = ROOT / "notebooks") -> list[str]:
    return [f"no {t}" for t in links(markdown(notebook)) if not (folder / t).exists()]


def has_claim(notebook: dict) -> list[str]:
    first = lines_of(notebook["cells"][0]["source"]).strip().splitlines()
    rest = [line for line in first[1:] if line.strip()]
    titled = notebook["cells"][0]["cell_type"] == "markdown" and first[0].startswith("# ")
    return [] if titled and rest else ["the first cell must be a title and the claim below it"]


def has_summary(notebook: dict) -> list[str]:
    """Ends with a summary that leads on to other chapters and back."""
    kind, last = notebook["cells"][-1]["cell_type"], lines_of(notebook["cells"][-1]["source"])
    if kind != "markdown" or not re.search(r"^#+ Summary", last, re.M):
        return ["the last cell must be a Summary"]
    return [] if len(links(last)) >= 2 else ["the summary must link onward and back"]


def shows_what_goes_wrong(notebook: dict) -> list[str]:
    headings = re.findall(r"^#+ (.+)$", markdown(notebook), re.MULTILINE)
    return [] if any("wrong" in h.lower() for h in headings) else ["no part on what goes wrong"]


def has_exercise(notebook: dict) -> list[str]:
    """A heading, and after it a cell that checks the answer."""
    seen = False
    for cell in notebook["cells"]:
        source = lines_of(cell["source"])
        seen = seen or bool(re.search(r"^#+ .*Exercise", source, re.MULTILINE))
        if seen and cell["cell_type"] == "code" and re.search(r"\bcheck_\w+\(", source):
            return []
    return ["no exercise with a check"]


def has_driven_panel(notebook: dict) -> list[str]:
    """A panel that is shown, and after it a cell that moves a control and asserts a result."""
    code = list(code_cells(notebook))
    made = r"(\w+) = (?:\w+\.)?(?:\w+Panel|Workbench)\("
    named = [re.match(made, source) for _, source, _ in code]
    for at, match in enumerate(named):
        driven = rf"^{match.group(1)}\.\w+\.value = [\s\S]*^assert " if match else None
        if driven and any(re.search(driven, s, re.MULTILINE) for _, s, _ in code[at + 1 :]):
            return []
    return ["no panel with a driven cell (move a control, assert what it shows)"]


def resets_its_panel(notebook: dict) -> list[str]:
    """After the last cell that uses it, a panel is again as the words above it describe it."""
    code = list(code_cells(notebook))
    made = r"(\w+) = (?:\w+\.)?(?!Live)\w+Panel\("
    left = []
    for name in (m.group(1) for _, source, _ in code if (m := re.match(made, source))):
        used = [(k, source) for k, source, _ in code if re.search(rf"\b{name}\.", source)]
        if used and not re.search(rf"^{name}\.reset\(\)$", used[-1][1], re.MULTILINE):
            left.append(f"cell {used[-1][0]}: ends without {name}.reset()")
    return left


#: Chapters in the new form ask for a prediction; `tests/course/form` has rules of their own for
#: them.
NEW_FORM_TAG = "predict"


def tags_of(cell: dict) -> list[str]:
    return list(cell["metadata"].get("tags", []))


def in_the_new_form(notebook: dict) -> bool:
    return any(NEW_FORM_TAG in tags_of(cell) for cell in notebook["cells"])


RULES = (executed_in_order, no_errors, no_widget_state, guards_are_folded, small, small_pictures,
         large_figures, words_between, steady_outputs, nothing_forbidden, shadows_no_builtin,
         short_plotting, short_cells, links_resolve, has_exercise, resets_its_panel)  # fmt: skip
OLD_FORM_RULES = (defines_nothing_twice, has_claim, has_summary, shows_what_goes_wrong,
                  has_driven_panel)  # fmt: skip
