"""What a call enters is what a reader of a method has to open: it stays as deep as its subject.

`python tests/kinds/test_closure.py` prints files and lines of code for each method.
"""

import ast
import json
import os
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

#: Files, and lines of code of the functions in them, that a method enters.
MOST = 15, 900
#: The methods that enter more: a figure here only falls.
LISTED = {
    "angle_correspondence": (16, 950),
    "pose_graph": (19, 1715),
}


@cache
def functions(file: str) -> dict[int, set[int]]:
    """The lines of each function of a file, without its docstring, by the first of them."""
    found = {}
    for node in ast.walk(ast.parse(Path(file).read_text("utf-8"))):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            lines = set(range(node.lineno, (node.end_lineno or 0) + 1))
            if ast.get_docstring(node) is not None:
                doc = node.body[0]
                lines -= set(range(doc.lineno, (doc.end_lineno or 0) + 1))
            found[min([node.lineno, *(d.lineno for d in node.decorator_list)])] = lines
    return found


def entered(call, root: str) -> tuple[int, int]:
    """How many files below a folder a call enters in this thread, and how many lines.

    It is called once before: what is prepared at a first call is no part of a method.
    """
    call()
    seen: dict[str, set[int]] = {}

    def note(frame, event, argument):
        code = frame.f_code
        if event == "call" and code.co_filename.startswith(root):
            seen.setdefault(code.co_filename, set()).add(code.co_firstlineno)

    sys.setprofile(note)
    try:
        call()
    finally:
        sys.setprofile(None)
    lines = {
        file: set().union(*(functions(file).get(first, set()) for first in firsts))
        for file, firsts in seen.items()
    }
    return sum(bool(each) for each in lines.values()), sum(map(len, lines.values()))


def measured() -> dict[str, tuple[int, int]]:
    """Files and lines of each method, as plain Python, on a log of 25 scans and a map of 8."""
    import segmap
    from segmap import alignment, reduction

    root, log = str(Path(segmap.__file__).parent), segmap.load("room")
    map = segmap.build_map(log[:8], log.truth[:8], keep_points=True)
    given = [(reduction.METHODS, map), (alignment.METHODS, log[:25])]
    calls = [
        (name, method.function, it) for methods, it in given for name, method in methods.items()
    ]
    return {name: entered(lambda f=f, it=it: f(it), root) for name, f, it in calls}


def test_what_is_entered_is_counted(tmp_path):
    """Catches a docstring that counts, a function inside one that counts twice, other files."""
    file = tmp_path / "one.py"
    file.write_text(
        'def f():\n    """Two\n    lines."""\n    def g():\n        return 1\n\n    return g()\n'
        "def unused():\n    pass\n"
    )
    scope: dict = {}
    exec(compile(file.read_text(), str(file), "exec"), scope)
    assert entered(scope["f"], str(tmp_path)) == (1, 5)
    assert entered(scope["f"], str(tmp_path / "other")) == (0, 0)


@pytest.mark.slow
def test_a_method_is_as_deep_as_its_subject():
    """Catches layers that only forward, and a file for each small function."""
    scope = os.environ | {"SEGMAP_PLAIN": "1"}
    told = subprocess.run(
        [sys.executable, __file__], env=scope, check=True, capture_output=True, text=True
    )
    found = {name: tuple(figures) for name, figures in json.loads(told.stdout).items()}
    assert LISTED.keys() <= found.keys()
    deeper = {
        name: (files, lines)
        for name, (files, lines) in found.items()
        if files > LISTED.get(name, MOST)[0] or lines > LISTED.get(name, MOST)[1]
    }
    assert deeper == {}


if __name__ == "__main__":
    print(json.dumps(measured(), indent=1))
