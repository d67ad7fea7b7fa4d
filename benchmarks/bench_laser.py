"""The laser in emulated real time: ten minutes of scans, and one live step with its drawing.

`python -m benchmarks.bench_laser 600` is the ten minutes; `make bench` takes thirty seconds.
"""

import contextlib
import sys
import time
from collections.abc import Iterator
from pathlib import Path

from segmap.emulator import Emulator
from segmap.hokuyo import SensorError, UrgSensor

from .measure import Row


def rows(seconds: float = 30.0) -> Iterator[Row]:
    try:
        yield soak(seconds)
    except SensorError as error:
        yield Row("laser", f"skipped: {error}")
        return


def soak(seconds: float) -> Row:
    """Scans delivered and dropped in emulated real time, memory at start and end."""
    with Emulator() as emulator, UrgSensor(emulator.port) as sensor:
        begun, before, gaps, last = time.monotonic(), None, [], None
        with contextlib.closing(sensor.scans()) as stream:
            for scan in stream:
                if sensor.delivered == 20:
                    before = megabytes()
                if last is not None:
                    gaps.append(scan.time - last)
                last = scan.time
                if time.monotonic() - begun > seconds:
                    break
        figure = (
            f"{sensor.delivered} delivered, {sensor.dropped} dropped {sensor.why!r}, "
            f"longest gap {max(gaps):.2f} s; "
            f"{before:.1f} MB after 2 s, {megabytes():.1f} MB at the end"
        )
    return Row(f"{seconds:g} s at 10 scans a second", figure, "none dropped, memory level")


def megabytes() -> float:
    """Memory that this process holds now; its most so far where the system does not tell."""
    status = Path("/proc/self/status")
    if status.exists():
        lines = dict(line.split(":", 1) for line in status.read_text().splitlines())
        return int(lines["VmRSS"].split()[0]) / 1000
    import resource

    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6


if __name__ == "__main__":
    for row in rows(float(sys.argv[1]) if len(sys.argv) > 1 else 600.0):
        print(row.what, row.figure, row.target, sep="\n  ")
