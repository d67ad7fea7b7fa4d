"""`segmap warm`: compile all loops now, or those that chapter 01 needs."""

from __future__ import annotations

import argparse
import importlib
import time
from collections.abc import Iterator
from typing import Any

from segmap import warm
from segmap.threads import cores

from ._output import print_line, progress
from .log_options import examples


def add(commands: Any) -> None:
    """Name the command and its arguments."""
    command = commands.add_parser(
        "warm",
        help="compile all loops now instead of at first use",
        epilog=examples("warm", "warm --first", "warm         again, once segmap is newer"),
    )
    command.add_argument("--first", action="store_true", help="only what chapter 01 needs")
    command.set_defaults(run=run)


def run(given: argparse.Namespace) -> None:
    """Compile, on all cores."""
    names, start = list(warm.FIRST if given.first else warm.cases()), time.monotonic()
    jobs = min(cores(), len(names))
    where = "one core" if jobs == 1 else f"{jobs} cores"
    what = "chapter 01" if given.first else "segmap"
    print_line(f"Compiling the loops of {what} on {where}, once for this machine ...")
    importlib.import_module("matplotlib.font_manager")  # lists the machine's fonts, once
    known, done = warm.cases(), set[Any]()
    with progress(len(warm.loops(known[name] for name in names)), "loop") as bar:
        bar.bar_format = "compiling loop {n_fmt} of {total_fmt} |{bar}|"
        for name in _run_all(names, jobs):
            done |= warm.loops([known[name]])
            bar.update(len(done) - bar.n)
    print_line(f"Done in {time.monotonic() - start:.0f} s.")


def _run_all(names: list[str], jobs: int) -> Iterator[str]:
    """Run cases; each is named when it is done."""
    if jobs == 1:
        for name in names:
            warm.run_case(name)
            yield name
        return
    from concurrent.futures import ProcessPoolExecutor, as_completed
    from multiprocessing import get_context

    # Processes, not threads: numba compiles one function at a time.
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        running = {pool.submit(warm.run_case, name): name for name in names}
        for done in as_completed(running):
            done.result()
            yield running[done]
