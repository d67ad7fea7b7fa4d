"""Damaged files by the hundred thousand: `make fuzz`, or `python tests/fuzz.py 5000 carmen maps`.

Every reader gets mutants of its samples, strict and lenient; maps, records and trajectories theirs.
A mutant is refused in the one way that is allowed, or what it holds is sound. Each target runs in a
process of its own, so that a crash is one, and tells its peak of memory. The first argument is the
number of mutants for a sample, names are targets, SEGMAP_SEED begins another series.
"""

import os
import random
import resource
import sys
import tempfile
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import NamedTuple

import damaged_maps
from damage import SEED, TARGETS, Target, mutated
from segmap_course import load_trials

from segmap.experiments import load_alignments, load_records, read_records
from segmap.readers import data_file

EACH = 4600


class Found(NamedTuple):
    """Of one target: mutants, what became of them, the slowest in seconds, and memory in MB."""

    name: str
    count: int
    ends: Counter[str]
    slowest: float
    memory: float


def map_bytes(folder: Path, rng: random.Random) -> list[str]:
    """The bytes of a sound file, damaged."""
    path = folder / "map.npz"
    damaged_maps.write(path, damaged_maps.sound())
    path.write_bytes(mutated(path.read_bytes(), rng))
    return ["refused" if damaged_maps.outcome(path) is None else "map"]


def map_arrays(folder: Path, rng: random.Random) -> list[str]:
    """A sound file that holds damaged arrays."""
    path = folder / "map.npz"
    damaged_maps.write(path, damaged_maps.damaged(rng))
    return ["refused" if damaged_maps.outcome(path) is None else "map"]


def table(
    read: Callable[[Path], object], head: bytes, folder: Path, rng: random.Random
) -> list[str]:
    """A CSV file; half of the mutants keep their head, so that a line is damaged."""
    path = folder / "table.csv"
    first, _, rest = head.partition(b"\n")
    kept = first + b"\n" if rng.random() < 0.5 else b""
    path.write_bytes(kept + mutated(rest if kept else head, rng).replace(b" ", b","))
    try:
        found = read(path)
    except ValueError as fault:
        assert "table.csv, line " in str(fault)
        return ["refused"]
    for name in ("n_before", "n_after", "scans", "used", "quality", "seconds", "median"):
        if name in getattr(found, "columns", ()):
            assert not (found[name] < 0).any()
    return ["read"]


def targets() -> dict[str, Target]:
    """Name of each target, and what makes and reads one mutant."""
    place = data_file("records")

    def beginning(path: Path) -> bytes:
        return b"".join(path.read_bytes().splitlines(keepends=True)[:4])

    found = dict(TARGETS)
    found |= {"map bytes": map_bytes, "map arrays": map_arrays}
    found["runs"] = partial(table, read_records, beginning(place / "malaga.csv"))
    found["alignments"] = partial(
        table, lambda path: load_alignments(path=path), beginning(place / "alignment.csv")
    )
    found["trials"] = partial(table, load_trials, beginning(place / "matching.csv"))
    return found


def attack(name: str, count: int) -> Found:
    """All mutants of one target; what nobody expects is told with the mutant's number."""
    warnings.simplefilter("error")
    rng, ends, slowest = random.Random(f"{SEED} fuzz {name}"), Counter[str](), 0.0
    target = targets()[name]
    load_records("malaga")  # pandas is there
    with tempfile.TemporaryDirectory() as folder:
        if name.startswith("map"):  # what is compiled too
            damaged_maps.write(Path(folder) / "it.npz", damaged_maps.sound())
            damaged_maps.outcome(Path(folder) / "it.npz")
        for number in range(count):
            begun = time.process_time()
            try:
                ends.update(target(Path(folder), rng))
            except Exception as fault:
                ends[f"FAULT {type(fault).__name__}"] += 1
                print(f"{name}, mutant {number} of SEGMAP_SEED={SEED}:", file=sys.stderr)
                traceback.print_exception(fault, limit=-4)
            if number:  # the first one loads modules
                slowest = max(slowest, time.process_time() - begun)
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    return Found(name, count, ends, slowest, memory)


def crashed(name: str, count: int) -> Found:
    """An attack in a process of its own."""
    try:
        with ProcessPoolExecutor(1, mp_context=get_context("fork")) as pool:
            return pool.submit(attack, name, count).result()
    except BrokenProcessPool:
        return Found(name, count, Counter({"CRASH": 1}), 0.0, 0.0)


def results(names: list[str], count: int) -> Iterator[Found]:
    for name in names:
        found = crashed(name, count)
        ends = ", ".join(f"{end} {n}" for end, n in sorted(found.ends.items()))
        print(f"{name:20} {1e3 * found.slowest:6.0f} ms {found.memory:5.0f} MB  {ends}", flush=True)
        yield found


def main(arguments: list[str]) -> int:
    """Attack, and say how it went: 1 where something crashed or failed in an unknown way."""
    count = int(arguments.pop(0)) if arguments and arguments[0].isdigit() else EACH
    unknown = set(arguments) - set(targets())
    if unknown:
        raise SystemExit(f"targets are {', '.join(targets())}; got {', '.join(unknown)}")
    begun = time.monotonic()
    found = list(results(arguments or list(targets()), count))
    total = sum((each.ends for each in found), Counter())
    bad = sum(n for end, n in total.items() if end.startswith(("FAULT", "CRASH")))
    slow, large = max(found, key=lambda f: f.slowest), max(found, key=lambda f: f.memory)
    print(f"{sum(each.count for each in found)} mutants in {time.monotonic() - begun:.0f} s")
    print(", ".join(f"{end} {n}" for end, n in sorted(total.items())))
    print(f"slowest {slow.slowest:.2f} s ({slow.name}), peak {large.memory:.0f} MB ({large.name})")
    return int(bad > 0)


if __name__ == "__main__":
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    sys.exit(main(sys.argv[1:]))
