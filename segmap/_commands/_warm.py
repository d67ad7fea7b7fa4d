"""`segmap warm`: compile all loops now."""

from __future__ import annotations

import argparse
import importlib
import time
from typing import TYPE_CHECKING, Any

from .. import _warm
from ..threads import cores
from ._output import print_line, progress
from .log_options import examples

if TYPE_CHECKING:
    from tqdm import tqdm


def add(commands: Any) -> None:
    """Name the command and its arguments."""
    command = commands.add_parser(
        "warm",
        help="compile all loops now instead of at first use",
        epilog=examples("warm", "warm --jobs 1", "warm --jobs 2"),
    )
    command.add_argument(
        "--jobs", type=int, metavar="NUMBER", help="processes; default: one for each core"
    )
    command.set_defaults(run=run)


def run(given: argparse.Namespace) -> None:
    """Compile, on all cores."""
    names, start = list(_warm.cases()), time.monotonic()
    jobs = max(1, min(given.jobs or cores(), len(names)))
    where = "one core" if jobs == 1 else f"{jobs} cores"
    print_line(f"Compiling the loops of segmap on {where}, once for this machine ...")
    importlib.import_module("matplotlib.font_manager")  # lists the machine's fonts, once
    with progress(len(names), "method") as bar:
        _run_all(names, jobs, bar)
    print_line(f"Done in {time.monotonic() - start:.0f} s.")


def _run_all(names: list[str], jobs: int, bar: tqdm[Any]) -> None:
    if jobs == 1:
        for name in names:
            _warm.run_case(name)
            bar.update()
        return
    from concurrent.futures import ProcessPoolExecutor, as_completed
    from multiprocessing import get_context

    # Processes, not threads: numba compiles one function at a time.
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        for done in as_completed([pool.submit(_warm.run_case, name) for name in names]):
            done.result()
            bar.update()
