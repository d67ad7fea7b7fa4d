"""How time and memory of the reduction methods grow with the map, from 1e3 to 1e6 segments.

Each of the largest runs has a process of its own, which also tells how much memory it has held:
`python -m benchmarks.bench_growth fusion 1000000 20`.
"""

import resource
import subprocess
import sys
from collections.abc import Iterator

import numpy as np

from segmap import METHODS, SegmentMap

from .measure import ROOT, Row, missing, once, seconds, workloads

SIZES = (1_000, 10_000, 100_000, 1_000_000)
#: Mean shift cuts walls into pieces; Hybrid with Fusion fuses a growing map again and again; the
#: surveyed methods are in part plain loops of Python.
LARGEST = dict.fromkeys(
    ("mean_shift", "hybrid_fusion", "polyline", "uncertain_parameters", "fuzzy_set"), 100_000
)
LARGEST |= dict.fromkeys(("fuzzy_clustering", "fusion_online", "weighted_line_fitting"), 10_000)
TARGETS = {
    "basic_offline": "1e5 <= 0.6 s, 1e6 in 6 s, n^1.2 from 1e4; < 4 GB",
    "basic_online": "< 4 GB",
    "fusion": "< 4 GB",
}


def rows() -> Iterator[Row]:
    made = workloads()
    if made is None:
        yield from missing("growth")
        return
    for seen in (20, 3):
        for name in (name for name, method in METHODS.items() if not method.needs_sensors):
            yield growth(made, name, seen)
    yield looks(made)


def looks(made) -> Row:
    """How least cost grows where 200 walls are seen more and more often."""
    seen = [25, 50, 100, 200]
    maps = [visits(made, 200 * k, k) for k in seen]
    took = [seconds(lambda m=m: METHODS["least_cost"](m), 3) for m in maps]
    figures = ", ".join(f"{t:.2f}" for t in took)
    what = "least_cost, 200 walls, seen 25 to 200 times"
    return Row(what, f"{figures} s: time ~ looks^{power(seen, took):.2f}", "<= 1.35")


def growth(made, name: str, seen: int) -> Row:
    sizes = [n for n in SIZES if n <= LARGEST.get(name, SIZES[-1])]
    took = [seconds(lambda m=visits(made, n, seen): METHODS[name](m), 3) for n in sizes[:-1]]
    last, megabytes = alone(name, sizes[-1], seen)
    took.append(last)
    whole, late = power(sizes, took), power(sizes[1:], took[1:])
    figures = ", ".join(f"{t:.4f}" for t in took)
    return Row(
        f"{name}, seen {seen}, n = 1e3 to 1e{np.log10(sizes[-1]):.0f}",
        f"{figures} s: time ~ n^{whole:.2f}, from 1e4 n^{late:.2f}; {megabytes:.0f} MB",
        TARGETS.get(name, ""),
    )


def power(sizes: list[int], took: list[float]) -> float:
    return float(np.polyfit(np.log(sizes), np.log(took), 1)[0])


def visits(made, n: int, seen: int) -> SegmentMap:
    """A building of n segments, each wall seen so many times; a scan brings eight segments."""
    segments = made.redundant_segments(n, seen=seen)[0].reshape(-1, 2, 2)
    return SegmentMap(segments, np.arange(n) // 8)


def alone(name: str, n: int, seen: int) -> tuple[float, float]:
    """Seconds, and the most memory in megabytes, of one run in a process of its own."""
    command = [sys.executable, "-m", "benchmarks.bench_growth", name, str(n), str(seen)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    took, megabytes = done.stdout.split()
    return float(took), float(megabytes)


def main(name: str, n: int, seen: int) -> None:
    made = workloads()
    METHODS[name](visits(made, 1000, seen))
    map = visits(made, n, seen)
    took = once(lambda: METHODS[name](map))
    unit = 1 if sys.platform == "darwin" else 1024
    print(took, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit / 1e6)


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]))
