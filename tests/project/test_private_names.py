"""Tests use public names: a file of tests that takes a private one stands in a list that shrinks.

`python tests/project/test_private_names.py` prints what each file of tests takes.
"""

import ast
import re
from pathlib import Path

TESTS = Path(__file__).parents[1]
#: What Python, pandas and IPython name with an underscore, though it is public.
PUBLIC = re.compile(r"_(?:_\w+__|replace|asdict|fields|make|repr_\w+_|ipython_\w+_)$")
#: Of other packages and of Python, which they give no other name.
OTHERS = ("_handle_custom_msg", "_dom_classes", "_instances", "_exit", "_parent_process")
#: A private name of ours, in a string that is given to `monkeypatch` or to another interpreter.
SPELLED = re.compile(r"\b(?:segmap|segmap_course)(?:\.\w+)*?(?:\.| import [^\n]*?\b)(_[a-zA-Z]\w*)")
BY_STRING = ("setattr", "getattr", "delattr", "hasattr")


def private(source: str) -> list[str]:
    """The private names of the project that a source takes, by import, attribute or string."""
    tree = ast.parse(source)
    own = {n.name for n in ast.walk(tree) if isinstance(n, ast.FunctionDef | ast.ClassDef)}
    docstrings = {id(n.value) for n in ast.walk(tree) if isinstance(n, ast.Expr)}
    found: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom):
            names = [f"{node.module}.{each.name}" for each in node.names]
            found |= {name for name in names if name.startswith("segmap") and hides(name)}
        elif isinstance(node, ast.Import):
            found |= {e.name for e in node.names if e.name.startswith("segmap") and hides(e.name)}
        elif isinstance(node, ast.Attribute):
            here = isinstance(node.value, ast.Name) and node.value.id in ("self", "cls")
            if not here and hides(node.attr) and node.attr not in (*own, *OTHERS):
                found.add(f"{ast.unparse(node.value)[:30]}.{node.attr}")
        elif isinstance(node, ast.Call) and ast.unparse(node.func).split(".")[-1] in BY_STRING:
            texts = [a.value for a in node.args if isinstance(a, ast.Constant)]
            found |= {text for text in texts if isinstance(text, str) and hides(text)}
        elif isinstance(node, ast.Constant) and id(node) not in docstrings:
            names = [match[0] for match in SPELLED.finditer(str(node.value))]
            found |= {name for name in names if hides(name)}
    return sorted(found)


def hides(name: str) -> bool:
    """Whether a part of a dotted name is private."""
    parts = re.split(r"[.\s]+", name)
    return any(part.startswith("_") and not PUBLIC.match(part) for part in parts)


if __name__ == "__main__":
    n = 0
    for path in sorted(TESTS.rglob("*.py")):
        if taken := private(path.read_text(encoding="utf-8")):
            n += 1
            print(f"{path.relative_to(TESTS)}: {', '.join(taken)}")
    print(n)
