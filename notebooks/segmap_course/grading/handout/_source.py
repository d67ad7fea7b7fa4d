"""The library's own source, taken apart: a function with all that it calls, as one text."""

from __future__ import annotations

import ast
import importlib
import re
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any


class Source:
    """The text of a module of segmap, by the names that it defines."""

    def __init__(self, module: str) -> None:
        self.module = module
        loaded = importlib.import_module(module)
        path = Path(str(loaded.__file__))
        self.text = path.read_text(encoding="utf-8")
        self.file = str(path)
        self.is_package = path.name == "__init__.py"
        self.nodes = {name: n for n in ast.parse(self.text).body for name in _names(n)}

    def code(self, node: ast.AST) -> str:
        """The text of a node; a function or class as it is now, without comments."""
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            return ast.unparse(node)
        return ast.get_source_segment(self.text, node) or ast.unparse(node)

    def origin(self, node: ast.ImportFrom) -> str:
        """The full name of the module that an import names."""
        base = self.module.split(".")
        base = base[: len(base) - node.level + self.is_package] if node.level else []
        return ".".join([*base, *([node.module] if node.module else [])])


def _names(node: ast.stmt) -> Iterator[str]:
    """The names that a statement of a module defines."""
    if isinstance(node, ast.FunctionDef | ast.ClassDef):
        yield node.name
    elif isinstance(node, ast.Import | ast.ImportFrom):
        yield from (alias.asname or alias.name for alias in node.names)
    elif isinstance(node, ast.Assign | ast.AnnAssign):
        targets = node.targets if isinstance(node, ast.Assign) else [node.target]
        parts = [part for target in targets for part in ast.walk(target)]
        yield from (part.id for part in parts if isinstance(part, ast.Name))


class Gatherer:
    """Collects the statements that a solution needs, each once, what it calls first.

    Copied is all of segmap, but for what is `given`: room -> the names that are imported from it.
    """

    def __init__(self, given: Mapping[str, Iterable[str]] = MappingProxyType({})) -> None:
        self.imports: list[str] = []
        self.parts: list[str] = []
        self._names: dict[tuple[str, str], str] = {}
        self._sources: dict[str, Source] = {}
        self._rooms = {
            (home.module, name): room
            for room, names in given.items()
            for name in names
            if (home := self._home(room, name)) is not None
        }

    def source(self, module: str) -> Source:
        """The text of a module, read once."""
        if module not in self._sources:
            self._sources[module] = Source(module)
        return self._sources[module]

    def gather(self, module: str, name: str) -> None:
        """Gather a function by the module that hands it out."""
        home = self._home(module, name)
        assert home is not None, f"{module} has no {name}"
        self.take(home, name)

    def needs(self, source: Source, node: ast.AST) -> str:
        """Gather all names of the module that a node uses; the text of the node, with these."""
        renamed: dict[str, str] = {}
        inside = set()
        for part in ast.walk(node):
            if isinstance(part, ast.Attribute) and isinstance(part.value, ast.Name):
                module = part.value.id
                if home := self._inside(source, module, part.attr):
                    renamed[f"{module}.{part.attr}"] = self.take(home, part.attr, module)
                    inside.add(module)
        for part in ast.walk(node):
            if isinstance(part, ast.Name) and part.id in source.nodes and part.id not in inside:
                renamed[part.id] = self.take(source, part.id)
        code = source.code(node)
        for old, new in renamed.items():
            if old != new:  # but no argument of this name
                code = re.sub(rf"(?<![\w.]){re.escape(old)}\b(?!=[^=])", new, code)
        return code

    def _inside(self, source: Source, module: str, name: str) -> Source | None:
        """Where `module.name` stands, if that belongs to the answer."""
        node = source.nodes.get(module)
        if not isinstance(node, ast.ImportFrom):
            return None
        alias = next(a.name for a in node.names if (a.asname or a.name) == module)
        home = self._home(f"{source.origin(node)}.{alias}", name)
        is_given = home is not None and (home.module, name) in self._rooms
        return None if is_given else home

    def take(self, source: Source, name: str, module: str = "") -> str:
        """Gather one name of a module, its text or an import; the name that it has from now on."""
        key = (source.module, name)
        if key in self._names:
            return self._names[key]
        node = source.nodes[name]
        if isinstance(node, ast.Import | ast.ImportFrom):
            self._names[key] = self._import(source, node, name)
            return self._names[key]
        # `arrays.points` is no `points`, which may be an argument.
        taken = bool(module) or name in self._names.values()
        room = module or source.module.rpartition(".")[2].strip("_")
        new = self._names[key] = f"{room}_{name.strip('_')}" if taken else name
        if isinstance(node, ast.FunctionDef):
            if words := ast.get_docstring(node):
                node.body[0] = ast.Expr(ast.Constant(words.splitlines()[0]))
            node.decorator_list = []  # the source of a function comes without them
            node.returns, arguments = None, node.args  # what annotations name is not needed then
            for one in (*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs):
                one.annotation = None
        code = self.needs(source, node)
        self.parts.append(re.sub(rf"\b{name}\b", new, code) if taken else code)
        return new

    def _import(self, source: Source, node: ast.Import | ast.ImportFrom, name: str) -> str:
        alias = next(a for a in node.names if (a.asname or a.name) == name)
        renamed = f" as {alias.asname}" if alias.asname else ""
        if isinstance(node, ast.Import):
            self.imports.append(f"import {alias.name}{renamed}")
            return name
        module = source.origin(node)
        home = self._home(module, alias.name)
        room = self._rooms.get((home.module, alias.name)) if home else None
        if home is not None and room is None:
            return self.take(home, alias.name)
        module = room or module
        self.imports.append(f"from {module} import {alias.name}{renamed}")
        return name

    def _home(self, module: str, name: str) -> Source | None:
        """The module of segmap in which a name is defined, behind all that hand it on."""
        while module.split(".")[0] in ("segmap", "segmap_course"):
            loaded = _module(module)
            if loaded is None or not hasattr(loaded, name):
                return None
            source = self.source(module)
            node = source.nodes.get(name)
            if not isinstance(node, ast.ImportFrom):
                return source if node is not None else None
            module = source.origin(node)
        return None


def _module(name: str) -> Any:
    """A module by its name; None where that is something inside a module."""
    try:
        return importlib.import_module(name)
    except ModuleNotFoundError:
        return None
