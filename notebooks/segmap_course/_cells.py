"""What an answer needs beside its own cell: it is graded by itself, after the imports."""

from __future__ import annotations

import ast
import builtins
import re
import sys
from collections.abc import Iterable, Sequence
from symtable import SymbolTable, symtable
from types import BuiltinFunctionType, FunctionType, ModuleType
from typing import Any

import numpy as np

#: How IPython writes a line that begins with `%` or `!`.
COMMAND = "get_ipython()"
#: What a notebook puts among the names of Python.
JUPYTER = {"display", "get_ipython"}
PYTHON = {*dir(builtins), "__name__", "__doc__"} - JUPYTER


def apart(needed: Iterable[str]) -> str:
    """What to tell whose answer needs these names."""
    names = sorted(needed)
    said = ", ".join(f"`{name}`" for name in names)
    if JUPYTER.intersection(names):
        return f"uses {said}, which only a notebook has: leave it out"
    return f"uses {said} of another cell: put {'it' if len(names) == 1 else 'them'} into this one"


def free_names(source: str) -> set[str]:
    """Names that a cell uses, and neither defines nor imports; without those of Python.

    Examples
    --------
    >>> sorted(free_names("def my_f(x): return helper(x) + len(LIMITS)"))
    ['LIMITS', 'helper']
    """
    tables = _tables(source)
    used = {
        s.get_name() for t in tables for s in t.get_symbols() if s.is_referenced() and s.is_global()
    }
    return used - bound_names(source) - PYTHON


def bound_names(source: str) -> set[str]:
    """Names that a cell gives a value to, imports too; none where it is no Python."""
    tables = _tables(source)
    top = tables[0].get_symbols() if tables else []
    return {symbol.get_name() for symbol in top if symbol.is_assigned() or symbol.is_imported()}


def _tables(source: str) -> list[SymbolTable]:
    try:
        tables = [symtable(source, "cell", "exec")]
        for table in tables:
            tables += table.get_children()
    except Exception:  # no Python, or too deep
        return []
    return tables


def imports_of(source: str) -> list[ast.Import | ast.ImportFrom]:
    """The imports of a cell, in which lines for Jupyter may stand."""
    lines = (line for line in source.splitlines() if not line.lstrip().startswith(("%", "!")))
    try:
        body = ast.parse("\n".join(lines)).body
    except Exception:  # no Python, or too deep
        return []
    found = [node for node in body if isinstance(node, ast.Import | ast.ImportFrom)]
    return [node for node in found if getattr(node, "module", "") != "__future__"]


# ----------------------------------------------------------------------------- in a notebook
def lacking(check: str, given: Any) -> str:
    """Why an answer that is right in this notebook is not where its cell runs alone; or nothing."""
    scope = getattr(given, "__globals__", vars(sys.modules["__main__"]))
    ran = scope.get("In")
    if not isinstance(ran, list):
        return ""
    for name in _checked(check, ran[-1]) or {getattr(given, "__name__", "")}:
        pattern = rf"\bdef {name}\b|\b{name} *=[^=]"
        cell = next((text for text in reversed(ran) if _gives(text, name, pattern)), "")
        if COMMAND in cell:
            return "its cell has a command of Jupyter (%, !), which is not Python: take it out"
        known = {n for text in ran for node in imports_of(text) for n in _names(node)}
        used = (free_names(cell) & {*scope, *JUPYTER}) - known
        if needed := {n for n in used if n in JUPYTER or not _imported(scope[n])}:
            return apart(needed)
    return ""


def _gives(text: str, name: str, pattern: str) -> bool:
    """Whether a cell gives a name its value; one that a command of Jupyter runs is a text in it."""
    return bool(re.search(pattern, text)) if COMMAND in text else name in bound_names(text)


def _checked(check: str, source: str) -> Sequence[str]:
    """The names that the last cell gives to a check."""
    try:
        calls = [node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Call)]
    except Exception:  # no Python, or too deep
        return []
    named = [c for c in calls if ast.unparse(c.func).removeprefix("course.") == check]
    parts = (part for call in named for argument in call.args for part in ast.walk(argument))
    return list(dict.fromkeys(part.id for part in parts if isinstance(part, ast.Name)))


def _names(node: ast.Import | ast.ImportFrom) -> list[str]:
    return [(alias.asname or alias.name).partition(".")[0] for alias in node.names]


def _imported(value: object) -> bool:
    """Whether a value is from a module: a star imports it without a name."""
    kinds = FunctionType, BuiltinFunctionType, type, np.ufunc
    own = isinstance(value, kinds) and getattr(value, "__module__", "") == "__main__"
    return isinstance(value, ModuleType) or (isinstance(value, kinds) and not own)
