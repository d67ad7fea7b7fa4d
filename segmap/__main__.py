"""Commands of the package itself: `python -m segmap warm` and `python -m segmap --version`."""

from __future__ import annotations

import argparse
import importlib
import os
import sys
import time
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import get_context

from tqdm import tqdm

from . import __version__, _warm


def main(arguments: list[str] | None = None) -> int:
    """Run a command; 0 where it went well."""
    given = _parser().parse_args(arguments)
    given.run(given)
    return 0


def _warm_up(given: argparse.Namespace) -> None:
    names, start = list(_warm.cases()), time.monotonic()
    jobs = max(1, min(given.jobs or _cores(), len(names)))
    where = "one core" if jobs == 1 else f"{jobs} cores"
    print(f"Compiling the loops of segmap on {where}, which is kept for later ...", flush=True)
    importlib.import_module("matplotlib.font_manager")  # lists the machine's fonts, once
    # On a terminal only; a log keeps the two lines.
    with tqdm(total=len(names), unit="method", disable=None, leave=False) as bar:
        if jobs == 1:
            for name in names:
                _warm.run(name)
                bar.update()
        else:
            # Processes, not threads: numba compiles one function at a time.
            with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
                for done in as_completed([pool.submit(_warm.run, name) for name in names]):
                    done.result()
                    bar.update()
    print(f"Done in {time.monotonic() - start:.0f} s.")


def _cores() -> int:
    """Cores that this process may use."""
    affinity = getattr(os, "sched_getaffinity", None)  # Linux
    return len(affinity(0)) if affinity else os.cpu_count() or 1


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m segmap", description=__doc__)
    parser.add_argument("--version", action="version", version=f"segmap {__version__}")
    commands = parser.add_subparsers(required=True, metavar="warm")
    command = commands.add_parser("warm", help="compile all loops now instead of at first use")
    command.add_argument("--jobs", type=int, help="processes; by default one for each core")
    command.set_defaults(run=_warm_up)
    return parser


if __name__ == "__main__":
    sys.exit(main())
