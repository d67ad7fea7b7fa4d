"""Each panel of the chapters with what it needs of its chapter: a few lines in place of all cells.

Read backwards from the cell that shows a panel, a statement is needed where it binds or changes a
name that is read later.
"""

import ast
import json
import symtable
from collections.abc import Iterator
from typing import Any, NamedTuple

from chapter_rules import CHAPTERS, parsed
from driven_panels import VIEW

SURE = (ast.Assign, ast.AnnAssign, ast.FunctionDef, ast.ClassDef, ast.Import, ast.ImportFrom)
CHANGES = (ast.Attribute, ast.Subscript)


class Shown(NamedTuple):
    """A panel: its chapter, the code that makes it as `shown` and ends with it, and its words."""

    chapter: str
    code: str
    words: str
    to_drag: bool


def panels() -> Iterator[Shown]:
    for path in CHAPTERS:
        notebook = json.loads(path.read_text(encoding="utf-8"))
        before: list[ast.stmt] = []
        for number, cell in parsed(notebook):
            before += cell.body
            for output in notebook["cells"][number]["outputs"]:
                shown = output.get("data", {})
                if VIEW in shown:
                    *lines, last = map(ast.unparse, needed(before))
                    code = "\n".join([*lines, f"shown = {last}", "shown"])
                    words = "".join(shown["text/plain"])
                    yield Shown(path.stem[:2], code, words, words.startswith("Drag"))


def needed(statements: list[ast.stmt]) -> list[ast.stmt]:
    """Those that the last of some statements needs, in order."""
    *before, last = map(Names, statements)
    functions = {each.node.name: each.read for each in before if isinstance(each.node, SURE[2:4])}
    packages = set().union(*(each.bound for each in before if isinstance(each.node, SURE[4:])))
    wanted, kept = reached(last.read, functions), [last.node]
    for each in reversed(before):
        changed = each.changed - packages
        if isinstance(each.node, ast.Expr):  # a drawing that goes on changes no panel
            changed &= last.read
        if wanted & (each.bound | changed):
            kept.append(each.node)
            if isinstance(each.node, SURE):
                wanted -= each.bound
            wanted |= reached(each.read, functions)
    return kept[::-1]


def reached(names: set[str], functions: dict[str, set[str]]) -> set[str]:
    """Names, and what the functions among them read when they are called."""
    found, new = set(), names
    while new:
        found |= new
        new = set().union(*(functions.get(name, set()) for name in new)) - found
    return found


class Names:
    """The names that a statement binds, reads, and those whose value it changes."""

    def __init__(self, node: ast.stmt) -> None:
        self.node = node
        top = symtable.symtable(ast.unparse(node), "cell", "exec")
        own = {s.get_name(): s for s in top.get_symbols()}
        inner = [s for scope in nested(top) for s in scope.get_symbols()]
        self.read = {name for name, s in own.items() if s.is_referenced()}
        self.read |= {s.get_name() for s in inner if s.is_global()}
        self.bound = {n for n, s in own.items() if s.is_assigned() or s.is_imported()}
        self.changed: set[str] = set()
        if isinstance(node, SURE[2:4]):
            return
        for part in ast.walk(node):
            if isinstance(part, ast.For):
                self.bound -= {n.id for n in ast.walk(part.target) if isinstance(n, ast.Name)}
            if isinstance(part, CHANGES) and isinstance(part.ctx, ast.Store):
                self.changed.add(root(part))
            if isinstance(part, ast.Expr) and isinstance(part.value, ast.Call):
                self.changed.add(root(part.value.func))
        self.changed -= {""}


def nested(table: Any) -> Iterator[Any]:
    for child in table.get_children():
        yield child
        yield from nested(child)


def root(node: ast.AST) -> str:
    """`a` of `a.b[c].d`; nothing of a plain name, which is called and not changed."""
    inside = node
    while isinstance(inside, CHANGES):
        inside = inside.value
    return inside.id if isinstance(inside, ast.Name) and inside is not node else ""
