"""Run every `bench_*.py` of this folder, or those whose names are given, and print their rows.

Those that keep records write them to `build/records`; with `--record` to `data/records`.
"""

import importlib
import platform
import sys
from pathlib import Path

from .measure import RECORDS, Row


def main(wanted: list[str]) -> int:
    wanted = [name for name in wanted if name != "--record"]
    names = sorted(path.stem for path in Path(__file__).parent.glob("bench_*.py"))
    chosen = [name for name in names if not wanted or name.removeprefix("bench_") in wanted]
    if not chosen:
        print(f"no benchmark named {' '.join(wanted)}: there are {' '.join(names)}")
        return 1
    RECORDS.mkdir(parents=True, exist_ok=True)
    print(f"Python {platform.python_version()}, {platform.machine()}; run alone on the machine")
    for name in chosen:
        print(f"\n{name.removeprefix('bench_')}")
        for row in importlib.import_module(f"benchmarks.{name}").rows():
            print(line(row), flush=True)
    return 0


def line(row: Row) -> str:
    target = f"  [{row.target}]" if row.target else ""
    return f"  {row.what:<58} {row.figure}{target}"


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
