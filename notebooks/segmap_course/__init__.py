"""What only the chapters need: exercises, panels, drawings, what moves; the theses' results.

`check_<name>(my_<name>)` compares a function with the library's and answers with a hint. All names
load together when the first is asked for, so that `literal` alone needs neither panel nor drawing.
"""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ._names import *

#: What `from segmap_course import ...` loads by itself.
_PACKAGES = "drawings", "exercises", "figures", "grading", "literal", "panels"


def __getattr__(name: str) -> Any:
    """A package, or one of all names; `__all__` too."""
    if name in _PACKAGES:
        return importlib.import_module(f"{__name__}.{name}")
    if name.startswith("_") and name != "__all__":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f"{__name__}._names"), name)


def __dir__() -> list[str]:
    return sorted(__getattr__("__all__"))
