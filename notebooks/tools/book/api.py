"""A page a package: its docstring, and each public name with its docstring and examples."""

import importlib
import inspect
import re
import types
from collections.abc import Iterator
from pathlib import Path
from typing import Any

#: The packages with public names, as a reader meets them.
PACKAGES = (
    *("segmap", "scans", "readers", "simulation", "angles", "poses", "segments", "extraction"),
    *(
        "metrics",
        "alignment",
        "reduction",
        "quadtree",
        "matching",
        "plan",
        "exports",
        "experiments",
    ),
    *("progress", "sensors", "sensors.emulator", "plotting", "panels", "testing", "arrays"),
    *("segmap_app.files", "segmap_app.page"),
    *("segmap_course", "segmap_course.literal"),
)


def write_api(folder: Path, packages: tuple[str, ...] = PACKAGES) -> None:
    """Write the pages of some packages, and one that lists them."""
    folder.mkdir(parents=True)
    seen: set[int] = set()
    for package in packages:
        (folder / f"{package}.rst").write_text(page(package, seen), encoding="utf-8")
    rows = "\n".join(f"   {package}" for package in packages)
    text = f"{INDEX}\n.. toctree::\n   :maxdepth: 1\n\n{rows}\n"
    (folder / "index.rst").write_text(text, encoding="utf-8")


INDEX = """API
===

Every public name of segmap, a page a package. All angles are in radians, lengths in metres, times
in seconds. Each example runs: the tests run them all.
"""


def page(package: str, seen: set[int]) -> str:
    """The source of a package's page; a class that another one has shown is not indexed again."""
    module = package_module(package)
    name = module.__name__
    head = f"{name}\n{'=' * len(name)}\n\n.. automodule:: {name}\n   :no-members:\n\n"
    own = "".join(_elsewhere(module) if package == "segmap" else _entries(module, seen))
    return f"{head}.. currentmodule:: {name}\n\n{own}"


def package_module(package: str) -> types.ModuleType:
    """The module of a package."""
    return importlib.import_module(package if package.startswith("segmap") else f"segmap.{package}")


def public_names(module: types.ModuleType) -> list[str]:
    """Classes and functions of `__all__`, or without underscore, that the package defines."""
    inside = re.compile(rf"{re.escape(module.__name__)}(\.|$)")
    return [
        name
        for name in getattr(module, "__all__", sorted(vars(module)))
        if name[0] != "_"
        and (value := getattr(module, name)) is not None
        and (inspect.isclass(value) or inspect.isroutine(value))
        and inside.match(getattr(value, "__module__", ""))
    ]


def _elsewhere(module: types.ModuleType) -> Iterator[str]:
    """The names of the package itself: where each is described."""
    for name in module.__all__:
        value = getattr(module, name)
        if inspect.ismodule(value):
            yield f"* :doc:`segmap.{name} <{name}>`: {_first(value)}\n"
        else:
            package = _home(value, name)
            yield f"* :py:obj:`segmap.{name} <segmap.{package}.{name}>`: {_first(value)}\n"


def _home(value: Any, name: str) -> str:
    if name == "METHODS":
        return "reduction"
    return str(value.__module__).split(".")[1]


def _first(value: Any) -> str:
    return (inspect.getdoc(value) or "").partition("\n\n")[0].replace("\n", " ")


def _entries(module: types.ModuleType, seen: set[int]) -> Iterator[str]:
    """Directives for each name: classes, then functions, then constants."""
    notes = _notes(module)
    names = [(name, getattr(module, name)) for name in public_names(module)]
    for name, value in sorted(names, key=lambda pair: _rank(pair[1])):
        if inspect.ismodule(value):
            continue
        if inspect.isclass(value):
            again = "   :no-index:\n" if id(value) in seen else ""
            seen.add(id(value))
            yield f".. autoclass:: {name}\n   :members:\n   :member-order: bysource\n{again}\n"
        elif inspect.isroutine(value) or (callable(value) and hasattr(value, "__wrapped__")):
            yield f".. autofunction:: {name}\n\n"
        else:
            said = notes.get(name) or _said(value)
            body = "".join(f"   {line}\n" for line in said.splitlines())
            yield f".. py:data:: {name}\n\n{body}\n"


def _rank(value: Any) -> int:
    return 0 if inspect.isclass(value) else 1 if callable(value) else 2


def _notes(module: types.ModuleType) -> dict[str, str]:
    """What `#:` comments say of constants, anywhere in the package."""
    home = Path(str(module.__file__))
    files = home.parent.glob("*.py") if home.name == "__init__.py" else [home]
    found: dict[str, str] = {}
    for text in (path.read_text(encoding="utf-8") for path in files):
        above = re.findall(r"^((?:#: .*\n)+)([A-Z_]+(?:, [A-Z_]+)*)\b", text, re.MULTILINE)
        beside = re.findall(r"^([A-Z_]+)\b.*?#: (.*)$", text, re.MULTILINE)
        for said, names in [*above, *((said, name) for name, said in beside)]:
            words = re.sub(r"^#: ", "", said, flags=re.MULTILINE).strip()
            found |= dict.fromkeys(names.split(", "), words)
    return found


def _said(value: Any) -> str:
    """What a constant without a note is: an exercise its task, another its value if short."""
    shown = getattr(value, "task", None) or repr(value)
    return f"``{shown}``" if len(shown) < 200 and "`" not in shown else ""
