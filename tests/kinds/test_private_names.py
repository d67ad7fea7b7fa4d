"""Tests use public names: a file of tests that takes a private one stands in a list that shrinks.

`python tests/kinds/test_private_names.py` prints what each file of tests takes.
"""

import ast
import re
from pathlib import Path

import pytest

TESTS = Path(__file__).parents[1]
#: The files that take some, each with its reason; a file that takes none any more leaves the list.
HELD = {
    "alignment/pose_graph/test_graph.py": "kernels against numpy: equations and their solver",
    "alignment/pose_graph/test_pose_graph.py": "steps of loop closing, a matcher that fails",
    "alignment/test_alignment.py": "kernels against `literal`; results that the runner refuses",
    "alignment/test_angle_correspondence.py": "kernels against `literal`",
    "alignment/test_backbone.py": "kernels against `literal`",
    "alignment/test_global_segments.py": "equations against their literal form",
    "alignment/test_point_map.py": "kernels against numpy: partners, steps and their uncertainty",
    "emulated.py": "faults of a wire, in the thread and by the clock of a test",
    "sensors/test_protocol.py": "bytes against the manual and captures, and damaged ones",
    "sensors/test_sensor_address.py": "crashes: a socket that is slow, dead or of another",
    "matching/test_live_map.py": "crashes: interrupts and threads that draw a map anew",
    "matching/test_localize.py": "steps against the `literal` filter",
    "matching/test_merge.py": "places that both sessions passed, and solutions on the way",
    "matching/test_particles.py": "steps against the `literal` filter",
    "app/page/test_hostile.py": "crashes: hostile words at every entry of the page",
    "panels/test_live.py": "crashes: threads of the panel, a scan that fails",
    "panels/test_live_picture.py": "pixels against a plain drawing",
    "app/page/test_workbench.py": "crashes: a worker that is stopped, killed or fails",
    "app/page/test_workbench_parts.py": "words and messages of the page, letter by letter",
    "project/test_compiled.py": "the compiler of kernels itself",
    "project/test_warm.py": "the compiler of kernels itself",
    "reduction/test_reduction.py": "results that the runner refuses: no method of ours gives them",
}
#: What Python, pandas and IPython name with an underscore, though it is public.
PUBLIC = re.compile(r"_(?:_\w+__|replace|asdict|fields|make|repr_\w+_|ipython_\w+_)$")
#: Of other packages and of Python, which they give no other name.
OTHERS = ("_handle_custom_msg", "_dom_classes", "_instances", "_exit", "_parent_process")
#: An import of ours in a string, which another interpreter runs.
SPELLED = re.compile(r"\b(?:from|import) (segmap[\w.]*(?: import [^\n]+)?)")
#: What takes a name by a string.
BY_STRING = ("setattr", "getattr", "delattr", "hasattr", "setitem", "import_module", "later")


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
            found |= {name for name in SPELLED.findall(str(node.value)) if hides(name)}
    return sorted(found)


def hides(name: str) -> bool:
    """Whether a part of a dotted name is private."""
    parts = re.split(r"[^\w]+", name)
    return any(part.startswith("_") and not PUBLIC.match(part) for part in parts)


def test_private_names_are_taken_by_listed_files_only():
    """Catches a test that must be rebuilt with the package that it tests."""
    found = {
        path.relative_to(TESTS).as_posix()
        for path in TESTS.rglob("*.py")
        if path != Path(__file__) and private(path.read_text(encoding="utf-8"))
    }
    assert found - HELD.keys() == set(), "test what a user sees"
    assert HELD.keys() - found == set(), "these take none any more: they leave the list"


@pytest.mark.parametrize(
    ("source", "count"),
    [
        ("from segmap.reduction import (\n    fusion,\n    _fusion,\n)", 1),
        ("from segmap.poses._poses import wrap\nimport segmap.matching._search", 2),
        ("from segmap import alignment\nalignment._verdict.grade()\npanel._draw(figure)", 2),
        ("monkeypatch.setattr('segmap.files._part', 3)\nmonkeypatch.setattr(map, '_tree', 3)", 2),
        ("run('-c', 'from segmap import readers, _warm')", 1),
        ("class A:\n    def _b(self): self._c = 1\nA()._b()", 0),
        ('"""Of `segmap._warm`."""\nfrom numpy._core import x\nrow._replace(a=1)', 0),
        ("from segmap.__main__ import main\nfound.__dict__, os._exit(0)", 0),
    ],
)
def test_private_names_are_found_however_they_are_taken(source, count):
    """Catches a count that sees imports of one line alone."""
    assert len(private(source)) == count


if __name__ == "__main__":
    for path in sorted(TESTS.rglob("*.py")):
        if taken := private(path.read_text(encoding="utf-8")):
            print(f"{path.relative_to(TESTS)}: {', '.join(taken)}")
