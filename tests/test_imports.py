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
    "_arguments",
    "_compiled _display _files _threads methods arrays",
    "_motions",
    "_units angles literal _information _segment_points",
    "poses segments",
    "scans kernels error_codes",
    "_coverage _placed",
    "readers simulation extraction metrics hokuyo",
    "reduction quadtree emulator",
    "alignment",
    "matching experiments exports",
    "testing",
    "plotting",
    "panels",
    "course",
    "segmap _warm",
    "_commands",
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


def named(path: Path) -> tuple[str, bool]:
    """The module of a file, and whether it is a package."""
    parts = path.relative_to(PACKAGE.parent).with_suffix("").parts
    is_package = parts[-1] == "__init__"
    return ".".join(parts[:-1] if is_package else parts), is_package


@pytest.mark.parametrize("path", sorted(PACKAGE.rglob("*.py")), ids=lambda p: p.stem)
def test_imports_run_downwards(path):
    module, is_package = named(path)
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


# ------------------------------------------------------------------ what is private stays inside

#: Imports of private names across rooms that are still to go: nothing may be added.
STILL_PRIVATE: set[str] = set()


def crossing(source: str, module: str, is_package: bool = False) -> list[str]:
    """Private names and files of other rooms that a module imports or reaches."""
    home = module.split(".") if is_package else module.split(".")[:-1]
    reached, local = [], {}
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.ImportFrom):
            base = home[: len(home) - node.level + 1] if node.level else []
            origin = [*base, *(node.module.split(".") if node.module else [])]
            found = {a.asname or a.name: [*origin, a.name] for a in node.names}
        elif isinstance(node, ast.Import):
            found = {a.asname or a.name: a.name.split(".") for a in node.names}
        elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            reached.append((node.value.id, node.attr))
            continue
        else:
            continue
        local |= found
    names = [*local.values(), *([*local[name], attr] for name, attr in reached if name in local)]
    ours = [".".join(n) for n in names if n[0] == "segmap" and _private(n)]
    return sorted({f"{module}: {name}" for name in ours if room_of(name) != room_of(module)})


def _private(name: list[str]) -> bool:
    """Whether a part below a room is private; a file of loops beside a room is that room's."""
    inside = name[1:] if name[1:] and name[1].endswith("_loops") else name[2:]
    return any(part.startswith("_") and not part.startswith("__") for part in inside)


@pytest.mark.parametrize(
    ("source", "count"),
    [
        ("from ..quadtree._tree import grow", 1),
        ("from ..quadtree import _tree", 1),
        ("from .._extraction_loops import fit_total", 1),
        ("import segmap.quadtree._tree", 1),
        ("from .. import quadtree\nquadtree._tree.grow()", 1),
        ("from ..quadtree import QuadtreeMap\nQuadtreeMap._of(1)", 1),
        ("from ._score import look_up\nfrom .._compiled import compiled\nself._x = 1", 0),
        ("from numpy._core import _x", 0),
    ],
)
def test_a_private_name_of_another_room_is_seen(source, count):
    assert len(crossing(source, "segmap.matching._field")) == count


@pytest.mark.parametrize("path", sorted(PACKAGE.rglob("*.py")), ids=lambda p: p.stem)
def test_no_private_name_crosses_rooms(path):
    module, is_package = named(path)
    found = crossing(path.read_text(encoding="utf-8"), module, is_package)
    assert [line for line in found if line not in STILL_PRIVATE] == []


# ------------------------------------------------------------------ everything is reachable


def test_every_room_is_reachable_after_import_segmap():
    """Catches a room that a newcomer must import by itself before it can be used."""
    shared = {"error_codes", "kernels", "methods", "data"}  # parts of several rooms
    rooms = {p.stem for p in PACKAGE.iterdir() if p.suffix in ("", ".py") and p.stem[0] != "_"}
    assert rooms - set(segmap.__all__) - shared == set()
    code = "import segmap\nfor name in segmap.__all__: assert getattr(segmap, name) is not None"
    subprocess.run([sys.executable, "-c", code], check=True)
    assert set(segmap.__all__) <= set(dir(segmap))
    assert sorted(set(segmap.__all__)) == sorted(segmap.__all__)


def test_a_missing_package_is_named_with_the_extra_that_brings_it():
    code = "import sys; sys.modules['ipywidgets'] = None\nfrom segmap import panels"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert "segmap.panels needs ipywidgets: pip install 'segmap[lab]'" in run.stderr
    with pytest.raises(AttributeError, match="no attribute 'pannels'"):
        _ = segmap.pannels


# ------------------------------------------------------------------ the house stays small

#: Files with more than 300 lines that are still to be cut: nothing may be added.
STILL_LONG = {"quadtree/_map.py", "metrics.py"}
#: The goal is 130 without the methods that A surveys (each is a plain file and a fast one or two),
#: formats (a file each), commands and the workbench.
MOST_FILES = 284


def test_files_are_few_and_short():
    """Catches a room that grows by a file a function, and a file that nobody reads to its end."""
    files = sorted(PACKAGE.rglob("*.py"))
    lines = {str(p.relative_to(PACKAGE)): len(p.read_text("utf-8").splitlines()) for p in files}
    assert {name for name, count in lines.items() if count > 300} <= STILL_LONG
    assert len(files) <= MOST_FILES
