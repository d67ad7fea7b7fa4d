"""The laser in emulated real time: ten minutes of scans, and one live step with its drawing.

`python -m benchmarks.bench_laser 600` is the ten minutes; `make bench` takes thirty seconds. What a
browser does with the picture is not in the live step.
"""

import contextlib
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from segmap.panels import LivePanel
from segmap.scans import LaserScan
from segmap.sensors import SensorError, UrgSensor, parse_scan
from segmap.sensors._geometry import laser_scan
from segmap.sensors._protocol import ScanRequest, encode_reply, encode_scan, parse_reply
from segmap.sensors.emulator import Emulator, furnished_room

from .measure import Row

#: Scans of the live map that are measured, and those before, which draw the first frames.
LIVE, FIRST = 200, 5


def rows(seconds: float = 30.0) -> Iterator[Row]:
    try:
        yield from live(LIVE)
        yield soak(seconds)
    except SensorError as error:
        yield Row("laser", f"skipped: {error}")


def live(scans: int, *, loops: bool = False) -> Iterator[Row]:
    """Whole steps of the live panel, started by its button, with the sensor in this process."""
    room = furnished_room()
    with Emulator(room) as emulator, UrgSensor(emulator.port) as sensor:
        panel = Measured(sensor, start=room.pose(0))
        panel.loops.value = loops
        panel.start.click()
        until = time.monotonic() + 60 + 0.2 * scans
        while len(panel.steps) < FIRST + scans and time.monotonic() < until:
            time.sleep(0.1)
        panel.stop.click()
        left_out = panel.dropped.value
    took = 1000 * np.array(panel.steps[FIRST : FIRST + scans])
    if len(took) < scans:
        raise SensorError(f"the live map ended after {len(took)} scans: {panel.state.value}")
    middle, high, most = np.percentile(took, [50, 95, 100])
    figure = f"median {middle:.0f} ms, p95 {high:.0f} ms, largest {most:.0f} ms; {left_out}"
    what = f"live step of {scans} scans: parse, match, insert, draw"
    yield Row(f"{what}, close loops" if loops else what, figure, "< 60 ms")
    fifth = scans // 5
    early, late = np.median(took[:fifth]), np.median(took[-fifth:])
    figure = f"{early:.0f} -> {late:.0f} ms, {panel.leaves.value}"
    yield Row("live step, first fifth -> last fifth", figure, "no growth")


class Measured(LivePanel):
    """The panel of chapter 29, which notes how long each whole step takes, seconds."""

    def __init__(self, source: UrgSensor, **settings: Any) -> None:
        self.steps: list[float] = []
        super().__init__(source, **settings)

    def take(self, scan: LaserScan) -> None:
        """As the panel does; the reading thread has parsed the scan before, so that is added."""
        super().take(scan)
        self.steps.append(self.seconds + parsing(scan, self.source))


def parsing(scan: LaserScan, sensor: Any) -> float:
    """Seconds from the bytes of a scan to the scan, made and read again."""
    request = ScanRequest(sensor.geometry.first, sensor.geometry.last)
    met = np.where(scan.codes == 0, np.rint(1000 * np.nan_to_num(scan.ranges, posinf=0)), 0)
    answer = encode_reply(request.text, "99", encode_scan(0, met.astype(int), 3))
    begun = time.perf_counter()
    reply = parse_reply(answer.split(b"\n")[:-2])
    laser_scan(parse_scan(reply.body, 3), sensor.geometry, time=0.0)
    return time.perf_counter() - begun


def soak(seconds: float) -> Row:
    """Scans delivered and dropped in emulated real time, memory at start and end."""
    with Emulator() as emulator, UrgSensor(emulator.port) as sensor:
        begun, before, gaps, last = time.monotonic(), megabytes(), [0.0], None
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
