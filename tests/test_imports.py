"""The storeys of the package: imports run downwards only, and `import segmap` stays light."""

import ast
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import segmap

PACKAGE = Path(segmap.__file__).parent

#: From the ground up. A room imports rooms of lower storeys only; a folder is one room.
STOREYS = (
    "_compiled _display methods arrays",
    "angles literal",
    "poses segments",
    "scans kernels error_codes",
    "readers simulation extraction metrics hokuyo",
    "alignment reduction quadtree emulator",
    "matching experiments exports",
    "testing",
    "plotting",
    "panels",
    "course",
    "segmap _warm",
    "__main__",
)
STOREY = {room: height for height, rooms in enumerate(STOREYS) for room in rooms.split()}

#: What `import segmap` must not load: they are slow, or absent where only the library is needed.
HEAVY = ("matplotlib", "ipywidgets", "serial", "numba", "IPython", "pandas", "tqdm")


def room_of(module: str) -> str:
    """`segmap.reduction._fusion` lives in reduction, `segmap._extraction_loops` in extraction."""
    parts = module.split(".")
    room = parts[1] if len(parts) > 1 else "segmap"
    return room.removeprefix("_").removesuffix("_loops") if room.endswith("_loops") else room


def imported(source: str, module: str, is_package: bool) -> Iterator[str]:
    """Modules that a source imports anywhere, in functions too, as absolute names."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            home = module.split(".") if is_package else module.split(".")[:-1]
            base = home[: len(home) - node.level + 1] if node.level else []
            name = ".".join([*base, *([node.module] if node.module else [])])
            yield from (f"{name}.{a.name}" for a in node.names) if name == "segmap" else [name]
        elif isinstance(node, ast.Call) and ast.unparse(node.func).endswith("import_module"):
            yield from (a.value for a in node.args if isinstance(a, ast.Constant))


def upward(source: str, module: str, is_package: bool = False) -> list[str]:
    """What a module of segmap imports from its own storey or above it."""
    own = room_of(module)
    assert own in STOREY, f"{module}: give the room {own!r} its place in STOREYS"
    rooms = {room_of(name) for name in imported(source, module, is_package) if _ours(name)}
    wrong = {r for r in rooms if r in STOREY and r != own and STOREY[r] >= STOREY[own]}
    return sorted(f"{own} -> {r}" for r in wrong)


def _ours(name: str) -> bool:
    return name.split(".")[0] == "segmap"


@pytest.mark.parametrize("path", sorted(PACKAGE.rglob("*.py")), ids=lambda p: p.stem)
def test_imports_run_downwards(path):
    parts = path.relative_to(PACKAGE.parent).with_suffix("").parts
    is_package = parts[-1] == "__init__"
    module = ".".join(parts[:-1] if is_package else parts)
    assert upward(path.read_text(encoding="utf-8"), module, is_package) == []


@pytest.mark.parametrize(
    ("module", "source"),
    [
        ("segmap.scans", "from .readers import read"),
        ("segmap.scans", "from . import readers"),
        ("segmap.scans", "import segmap.readers._carmen"),
        ("segmap.scans", "def f():\n    from segmap import readers"),
        ("segmap.poses", "from .segments import length"),
        ("segmap.metrics", "from .extraction import fit_line"),
        ("segmap.reduction._fusion", "from ..plotting import draw_segments"),
        ("segmap.scans", "import importlib\nimportlib.import_module('segmap.plotting')"),
    ],
)
def test_an_upward_import_is_seen(module, source):
    """Catches a test that looks at one spelling of `import` only."""
    assert len(upward(source, module)) == 1


def test_what_is_allowed_passes():
    """Catches a test that forbids siblings of a family or imports from elsewhere."""
    family = "from ._result import Reduction\nfrom ..segments import length\nimport numpy"
    assert upward(family, "segmap.reduction._fusion") == []


def test_a_room_without_a_place_is_asked_for_one():
    with pytest.raises(AssertionError, match="give the room 'cellar' its place"):
        upward("", "segmap.cellar")


@pytest.mark.parametrize("name", ["segmap", "segmap.simulation", "segmap.readers"])
def test_import_is_light(name):
    """Catches an import at the top of a file that belongs into a function."""
    code = f"import {name}, sys; print(*sys.modules)"
    loaded = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert "segmap.segments" in loaded.stdout.split()
    assert [m for m in HEAVY if m in loaded.stdout.split()] == []


def test_a_notebook_draws_though_only_segmap_was_imported():
    """Catches drawings that are registered only once somebody imports segmap.plotting."""
    code = "import segmap; print(*segmap.load('room')[0]._repr_mimebundle_())"
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert shown.stdout.split() == ["text/plain", "image/png"]
