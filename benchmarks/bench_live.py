"""Whole steps of the live panel that closes loops, drawing included, at ten scans a second.

`python -m benchmarks.bench_live` takes all of Intel, five minutes; `make bench` its first third.
"""

import sys
import time
from collections.abc import Iterator

import numpy as np

from segmap import Log, read
from segmap.panels import LivePanel
from segmap.sensors import SensorError

from .bench_laser import live
from .measure import SHARED, Row, missing

#: Seconds between scans.
TURN = 0.1
GOAL = "< 60 ms"
#: The first steps draw the frame, and load what is left.
FIRST = 5


def rows(scans: int = 900) -> Iterator[Row]:
    path = SHARED / "data" / "intel.log.gz"
    if path.exists():
        yield from steps("Intel", read(path)[:scans])
    else:
        yield from missing("Intel, live")
    try:
        yield from live(200, loops=True)
    except SensorError as error:
        yield Row("live step that closes loops", f"skipped: {error}")


def steps(name: str, log: Log) -> Iterator[Row]:
    """Each scan comes at its time; the panel takes all of them, late or not."""
    panel = LivePanel(list(log))
    panel.loops.value = True
    panel.run(0)
    took, cpu, closed, new = [], [], [], []
    begun = time.perf_counter()
    for k, scan in enumerate(log):
        time.sleep(max(begun + TURN * k - time.perf_counter(), 0.0))
        tree, before = panel.map.tree, time.thread_time()
        panel.take(scan)
        cpu.append(1000 * (time.thread_time() - before))
        took.append(1000 * panel.seconds)
        closed.append(panel._step is not None and panel._step.closed)
        new.append(panel.map.tree is not tree)
    many = f"{sum(closed)} scans closed loops, {sum(new)} new maps"
    yield Row(f"{name}, {len(log)} live steps that close loops", f"{spread(took)}; {many}", GOAL)
    yield Row(f"{name}, the same, time of the processor", spread(cpu), GOAL)
    late = 100 * np.mean(np.array(cpu[FIRST:]) > 60)
    begun = time.perf_counter()
    panel.finish()
    figure = f"{late:.1f} % of steps; last map {time.perf_counter() - begun:.1f} s after the end"
    yield Row(f"{name}, longer than 60 ms on the processor", figure, "0 %")


def spread(ms: list[float]) -> str:
    """Median, 95th percentile and largest of the steps after the first few."""
    middle, high, most = np.percentile(ms[FIRST:], [50, 95, 100])
    return f"median {middle:.0f} ms, p95 {high:.0f} ms, largest {most:.0f} ms"


if __name__ == "__main__":
    for row in rows(int(sys.argv[1]) if len(sys.argv) > 1 else 2672):
        print(row.what, row.figure, row.target, sep="\n  ")
