"""On-line methods on whole logs: time for each scan against the segments in the map."""

from collections.abc import Iterator

import numpy as np

from segmap import METHODS, SegmentMap, build_map, load, read

from .measure import SHARED, Row, missing

PARTS = 10


def rows() -> Iterator[Row]:
    path = SHARED / "data" / "intel.log.gz"
    logs = [load("malaga")] + ([read(path)] if path.exists() else [])
    for log in logs:
        map = build_map(log, log.truth)
        for name, method in METHODS.items():
            if method.online and not method.needs_sensors:
                yield scans(f"{name}, {log.name}", method, map)
    if not path.exists():
        yield from missing("Intel, 2672 scans")


def scans(what: str, method, map: SegmentMap) -> Row:
    """Means of the first and the last tenth of the scans, and the exponent over all tenths."""
    runs = [method(map) for _ in range(6)][1:]
    took = np.median([found.scan_seconds for found in runs], axis=0)
    times = np.array([part.mean() for part in np.array_split(took, PARTS)])
    live = np.array([part.mean() for part in np.array_split(runs[0].scan_live, PARTS)])
    power = np.polyfit(np.log(live), np.log(times), 1)[0]
    return Row(
        f"{what}, {len(took)} scans",
        f"{1e3 * took.sum():.1f} ms; {1e6 * times[0]:.1f} -> {1e6 * times[-1]:.1f} us a scan, "
        f"{live[0]:.0f} -> {live[-1]:.0f} live: time ~ live^{power:.2f}",
        "live^1 or less",
    )
