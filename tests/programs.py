"""Programs as a terminal starts them: `program("segmap")` is what `python -m segmap` runs."""

from collections.abc import Callable
from importlib import import_module


def program(package: str, name: str = "main") -> Callable:
    """The entry point of a package, or another name beside it."""
    return getattr(import_module(f"{package}.__main__"), name)
