"""`my_mapper.py`: functions of a student that passed their checks, to map a building with them."""

from __future__ import annotations

import ast
from collections.abc import Callable
from inspect import getsource, ismodule
from pathlib import Path
from textwrap import dedent
from typing import Any

from segmap.files import write_bytes

#: `segmap notebooks FOLDER` puts it beside the chapters; where it is not, nothing is kept.
FILE = "my_mapper.py"


def keep(function: Callable[..., Any], name: str) -> str:
    """Add a function to `my_mapper.py` of this folder under a name; words on what was done.

    What it uses comes with it: imports, numbers and other functions of the notebook. One that is
    there already is not changed: the last one counts. The words are empty where the file is not
    there, or holds the same already.

    Examples
    --------
    >>> keep(max, "largest")
    ''
    """
    path = Path(FILE)
    if not path.is_file():
        return ""
    try:
        source = source_with_imports(function)
    except (OSError, TypeError, ValueError) as error:
        return f"not kept in {FILE}: {error}"
    if function.__name__ != name:
        source += f"\n{name} = {function.__name__}\n"
    before = path.read_text()
    if before.endswith(source):
        return ""
    write_bytes(path, f"{before}\n\n{source}".encode())
    again = f"\n{name} = " in before or f"\ndef {name}(" in before
    return (
        f"kept in {FILE}, below the one of before, which no longer counts"
        if again
        else (f"kept in {FILE}")
    )


def source_with_imports(function: Callable[..., Any]) -> str:
    """The source of a function behind that of what it uses, which runs alone.

    Raises
    ------
    ValueError
        Where it is a lambda, or uses a variable of the notebook that is neither a number, a text, a
        function nor a module.
    """
    if function.__name__ == "<lambda>":
        raise ValueError("a lambda has no name; write it with def")
    source = dedent(getsource(function))
    nodes = list(ast.walk(ast.parse(source)))
    own = {node.arg for node in nodes if isinstance(node, ast.arg)} | {function.__name__}
    names = [node for node in nodes if isinstance(node, ast.Name)]
    own |= {name.id for name in names if isinstance(name.ctx, ast.Store)}
    used = sorted({name.id for name in names} - own)
    scope = function.__globals__
    return "\n".join([*(_line(name, scope[name]) for name in used if name in scope), "", source])


def _line(name: str, value: Any) -> str:
    """The line, or lines, that make a name mean a value."""
    if ismodule(value):
        return f"import {value.__name__} as {name}"
    if isinstance(value, int | float | str):
        return f"{name} = {value!r}"
    module, own = getattr(value, "__module__", None), getattr(value, "__name__", None)
    if own is None or module is None:
        raise ValueError(f"it uses {name}, a variable of the notebook: give it as an argument")
    if module == "__main__":
        return source_with_imports(value)
    return f"from {module} import {own}" + f" as {name}" * (own != name)
