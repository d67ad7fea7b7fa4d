"""The layers of all packages: imports run downwards only, and `import segmap` stays light."""

import ast
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
import segmap_course

import segmap
import segmap_app

PACKAGES = [Path(package.__file__).parent for package in (segmap, segmap_app, segmap_course)]
SOURCES = sorted(path for package in PACKAGES for path in package.rglob("*.py"))

#: From the ground up. A package imports packages of lower layers only; a folder is one package.
LAYERS = (
    "progress",
    "compiled display",
    "arrays",
    "files threads methods",
    "angles",
    "poses segments",
    "scans kernels",
    "readers simulation extraction metrics",
    "sensors reduction quadtree",
    "alignment plan",
    "matching experiments exports",
    "testing warm carried",
    "plotting",
    "panels",
    "segmap",
    "segmap_app",
    "segmap_app.call segmap_app.files",
    "segmap_app.pipeline",
    "segmap_app.plans segmap_app.drives",
    "segmap_app.page",
    "segmap_app.commands segmap_course",
    "__main__",
)
LAYER = {package: height for height, packages in enumerate(LAYERS) for package in packages.split()}

#: What `import segmap` must not load: they are slow, or absent where only the library is needed.
#: What `import segmap` may load beside Python's own: numpy without masked arrays, nothing of scipy.
MAY_BE_LOADED = {"segmap", "numpy"}


def package_of(module: str) -> str:
    """`segmap.reduction._fusion` lives in reduction, all of the course in segmap_course."""
    parts = module.split(".")
    if parts[0] == "segmap_app":
        return ".".join(parts[:2])
    return parts[1] if parts[0] == "segmap" and len(parts) > 1 else parts[0]


def named(path: Path) -> tuple[str, list[str]]:
    """The module of a file, and the package that its relative imports start from."""
    package = next(p for p in PACKAGES if path.is_relative_to(p))
    parts = list(path.relative_to(package.parent).with_suffix("").parts)
    return ".".join(parts).removesuffix(".__init__"), parts[:-1]


def imported(source: str, home: list[str]) -> Iterator[list[str]]:
    """What a source imports or reaches of ours, in functions too, as absolute names in parts."""
    local: dict[str, list[str]] = {}
    for node in ast.walk(ast.parse(source)):
        found = {}
        if isinstance(node, ast.Import):
            found = {a.asname or a.name: a.name.split(".") for a in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = home[: len(home) - node.level + 1] if node.level else []
            base = [*base, *(node.module.split(".") if node.module else [])]
            found = {a.asname or a.name: [*base, a.name] for a in node.names}
        elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            if node.value.id in local:
                found = {"": [*local[node.value.id], node.attr]}
        elif isinstance(node, ast.Call) and ast.unparse(node.func).endswith("import_module"):
            found = {
                str(a.value): str(a.value).split(".") for a in node.args if hasattr(a, "value")
            }
        local |= found
        yield from (
            name for name in found.values() if name[0] in ("segmap", "segmap_app", "segmap_course")
        )


def upward(source: str, module: str, home: list[str]) -> list[str]:
    """The packages of its own layer, or above it, that a module imports."""
    own = package_of(module)
    assert own in LAYER, f"{module}: give the package {own!r} its place in LAYERS"
    packages = {package_of(".".join(name)) for name in imported(source, home) if len(name) > 1}
    barred = {r for r in packages if own == "segmap_course" and r.startswith("segmap_app")}
    higher = {r for r in packages if r in LAYER and r != own and LAYER[r] >= LAYER[own]}
    return sorted(higher | barred)


def crossing(source: str, home: list[str]) -> list[str]:
    """Private names and files that a module takes from a folder that it does not lie in."""
    private = []
    for name in imported(source, home):
        hidden = [k for k, part in enumerate(name) if part[0] == "_" and part[:2] != "__"]
        if hidden and home[: hidden[0]] != name[: hidden[0]]:
            private.append(".".join(name))
    return sorted(set(private))


@pytest.mark.parametrize("path", SOURCES, ids=lambda p: named(p)[0])
def test_imports_run_downwards_and_leave_private_names(path):
    module, home = named(path)
    source = path.read_text(encoding="utf-8")
    assert upward(source, module, home) == []
    assert crossing(source, home) == []


def python(code: str, *options: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, *options, *(["-c", code] if code else [])]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def loaded_by(name):
    """The modules that an import loads."""
    new = "(m for m in {*sys.modules} - before if hasattr(sys.modules[m], '__file__'))"
    loaded = python(f"import sys; before = {{*sys.modules}}; import {name}; print(*{new})")
    return loaded.stdout.split()


@pytest.mark.parametrize("name", ["segmap", "segmap.simulation", "segmap.readers"])
def test_import_is_light(name):
    """Catches an import at the top of a file that belongs into a function."""
    loaded = loaded_by(name)
    assert {m.split(".")[0] for m in loaded} - sys.stdlib_module_names == MAY_BE_LOADED
    assert [m for m in loaded if m.startswith("numpy.ma.")] == []


def test_the_literal_methods_load_alone():
    """Catches a panel, drawing or exercise behind the oracle of 24 test files."""
    loaded = loaded_by("segmap_course.literal")
    packages = {m.split(".")[0] for m in loaded} - sys.stdlib_module_names
    assert packages == {*MAY_BE_LOADED, "segmap_course"}
    course = [m for m in loaded if m.startswith("segmap_course.")]
    assert course and all(m.startswith("segmap_course.literal") for m in course)


def test_a_notebook_draws_though_only_segmap_was_imported():
    """Catches drawings that are registered only once somebody imports segmap.plotting."""
    shown = python("import segmap; print(*segmap.load('room')[0]._repr_mimebundle_())")
    assert shown.stdout.split() == ["text/plain", "image/png"]


def test_every_room_is_reachable_after_import_segmap():
    """Catches a package that a newcomer must import by itself before it can be used."""
    shared = {"carried", "compiled", "data", "display", "files", "kernels", "methods", "threads"}
    shared |= {"warm"}
    packages = {
        p.stem for p in PACKAGES[0].iterdir() if p.suffix in ("", ".py") and p.stem[0] != "_"
    }
    assert packages - set(segmap.__all__) - shared == set()
    reached = python("import segmap\nfor name in segmap.__all__: getattr(segmap, name).__name__")
    assert "ModuleNotFound" not in reached.stderr
    assert {*dir(segmap)} == {*segmap.__all__, "__version__"}, "and nothing that is not ours"


def test_a_missing_package_is_named_with_the_extra_that_brings_it():
    run = python("import sys; sys.modules['ipywidgets'] = None\nfrom segmap import panels")
    assert "segmap.panels needs ipywidgets: pip install anywidget ezdxf ipywidgets" in run.stderr
    with pytest.raises(AttributeError, match="no attribute 'pannels'"):
        _ = segmap.pannels
