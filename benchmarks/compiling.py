"""What numba compiles while something runs, and what each kernel costs in CPU seconds.

    python -m benchmarks.compiling                      all kernels, starting with an empty cache
    python -m benchmarks.compiling reduction matching   what these rooms need
    python -m benchmarks.compiling --chapter 01         what a chapter needs

A kernel is charged for itself and for the library functions that numba compiles on its behalf (the
sort inside it, say), not for the kernels that it calls. The last line is the sum.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stdout
from pathlib import Path
from typing import Any, NamedTuple

from .measure import ROOT


class Compilation(NamedTuple):
    """One signature of one kernel: CPU seconds of itself, and of each library function for it."""

    kernel: str
    signature: str
    own: float
    library: dict[str, float]

    @property
    def total(self) -> float:
        return self.own + sum(self.library.values())

    def line(self) -> str:
        dear = sorted(self.library.items(), key=lambda item: -item[1])[:4]
        text = ", ".join(f"{name} {cost:.2f}" for name, cost in dear if cost > 0.05)
        return f"{self.total:6.2f} {self.own:6.2f}  {self.kernel}({self.signature[:110]})  {text}"


@contextmanager
def recorded(done: list[Compilation]) -> Iterator[None]:
    """Append what is compiled inside; what the cache holds is not compiled."""
    from numba.core import event

    open_: list[dict[str, Any]] = []

    class Watch(event.Listener):
        def on_start(self, happened: event.Event) -> None:
            started = {"at": time.process_time(), "inner": 0.0, "library": {}}
            open_.append(happened.data | started)

        def on_end(self, happened: event.Event) -> None:
            last = open_.pop()
            whole = time.process_time() - last["at"]
            function, caller = last["dispatcher"].py_func, open_[-1] if open_ else None
            if caller:
                caller["inner"] += whole
            if function.__module__.startswith("segmap"):
                name = f"{function.__module__.removeprefix('segmap.')}.{function.__qualname__}"
                signature = ", ".join(map(str, last["args"]))
                done.append(Compilation(name, signature, whole - last["inner"], last["library"]))
            elif caller:
                costs = {function.__name__: whole - last["inner"]} | last["library"]
                for name, cost in costs.items():
                    caller["library"][name] = caller["library"].get(name, 0.0) + cost

    with event.install_listener("numba:compile", Watch()):
        yield


def cases(rooms: list[str]) -> Iterator[Callable[[], object]]:
    """The calls that warm these rooms, or all."""
    from segmap import warm

    for name, call in warm.cases().items():
        if not rooms or name.split()[0] in rooms:
            yield call


def cells(number: str) -> Iterator[Callable[[], object]]:
    """The code cells of a chapter, without a notebook's kernel."""
    import matplotlib

    matplotlib.use("agg")
    path = next((ROOT / "notebooks").glob(f"{number}_*.ipynb"))
    os.chdir(path.parent)
    scope: dict[str, Any] = {}
    for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
        if cell["cell_type"] == "code":
            source = compile("".join(cell["source"]), path.name, "exec")
            yield lambda source=source: exec(source, scope)  # type: ignore[misc]


def measure(calls: Iterator[Callable[[], object]]) -> tuple[list[Compilation], list[float]]:
    """What the calls compiled, and how long each took."""
    done: list[Compilation] = []
    took = []
    with recorded(done), Path(os.devnull).open("w") as nowhere, redirect_stdout(nowhere):
        for call in calls:
            start = time.perf_counter()
            call()
            took.append(time.perf_counter() - start)
    return done, took


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser("python -m benchmarks.compiling", description=__doc__)
    parser.add_argument("rooms", nargs="*")
    parser.add_argument("--chapter", help="its number, such as 01")
    parser.add_argument("--cache", help="a folder to use as cache; by default a new, empty one")
    parser.add_argument("--kept", action="store_true", help="use the cache that is always used")
    parser.add_argument("--json", action="store_true", help="print sum, count and longest call")
    asked = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory() as empty:
        if not asked.kept:  # numba looks at it when it is imported
            os.environ["NUMBA_CACHE_DIR"] = asked.cache or empty
        done, took = measure(cells(asked.chapter) if asked.chapter else cases(asked.rooms))
    total = sum(each.total for each in done)
    if asked.json:
        print(json.dumps({"seconds": total, "count": len(done), "longest": max(took)}))
        return 0
    for each in sorted(done, key=lambda each: -each.total):
        print(each.line())
    print(
        f"{total:6.2f} CPU seconds for {len(done)} signatures; the longest call {max(took):.1f} s"
    )
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
