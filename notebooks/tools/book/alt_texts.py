"""What a picture shows, for who cannot see it: its titles, or the sentence above its cell."""

import ast
import re
from collections.abc import Iterator

from nbformat import NotebookNode

#: Names that chapters give to the titles of a figure before they are drawn.
NAMES = re.compile(r"^(title|claim|shown$|maps$|cases$)")
#: Calls whose text is a title, and which argument it is.
CALLS = {"set_title": 0, "suptitle": 0, "label_axes": 1, "draw_maps": 0, "draw_cases": 0}
MARKUP = re.compile(r"\[([^\]]*)\]\([^)]*\)|[*`$\\]")


def alt_text(cell: NotebookNode, above: str = "") -> str:
    """Titles in its cell, the last sentence above where they are computed; empty without one."""
    shown = [output for output in cell.outputs if "image/png" in output.get("data", {})]
    if not shown:
        return ""
    said = shown[0].data.get("text/plain", "")
    titles = [said] if said and not said.startswith("<Figure") else list(titles_in(cell.source))
    sentence = MARKUP.sub(r"\1", above.strip().rpartition("\n")[2])
    last = re.split(r"(?<=[.?!]) (?=[A-Z])", sentence.lstrip("# "))[-1].rstrip(":")
    first = [last] if last and any("..." in title for title in titles) else []
    return "; ".join(dict.fromkeys([*first, *titles])) or last or "Figure that the code above draws"


def stored_alt(cell: NotebookNode) -> str:
    """What the chapter says of its picture since it was refreshed, else its titles."""
    known = (output.get("metadata", {}).get("image/png", {}) for output in cell.outputs)
    return next((words["alt"] for words in known if words.get("alt")), "") or alt_text(cell)


def titles_in(source: str) -> Iterator[str]:
    """The titles that a cell writes, in its order; "..." for what is computed."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Assign):
            yield from _assigned(node.targets[0], node.value)
        elif isinstance(node, ast.Call):
            name = getattr(node.func, "attr", getattr(node.func, "id", ""))
            if name in CALLS and len(node.args) > CALLS[name]:
                yield from _texts(node.args[CALLS[name]])
            yield from (
                t for word in node.keywords if word.arg == "title" for t in _texts(word.value)
            )


def _assigned(target: ast.expr, value: ast.expr) -> Iterator[str]:
    if isinstance(target, ast.Name) and NAMES.match(target.id):
        yield from _texts(value)
    elif isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple):
        for one, given in zip(target.elts, value.elts, strict=False):
            yield from _assigned(one, given)


def _texts(value: ast.expr) -> Iterator[str]:
    """A text, or those of a tuple, a list, or the keys of a dictionary."""
    if isinstance(value, ast.Constant) and isinstance(value.value, str):
        yield value.value
    elif isinstance(value, ast.JoinedStr):
        yield "".join(
            part.value if isinstance(part, ast.Constant) else "..." for part in value.values
        )
    elif isinstance(value, ast.Tuple | ast.List):
        yield from (text for part in value.elts for text in _texts(part))
    elif isinstance(value, ast.Dict):
        yield from (text for key in value.keys if key for text in _texts(key))
