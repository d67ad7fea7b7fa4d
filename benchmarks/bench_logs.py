"""Casting rays and reading logs."""

from collections.abc import Iterator

import numpy as np

from segmap import load, read, simulation

from .measure import SHARED, Row, missing, seconds


def rows() -> Iterator[Row]:
    walls = np.random.default_rng(0).uniform(-5, 5, (200, 2, 2))
    angles = np.linspace(-2.09, 2.09, 682)
    cast = seconds(lambda: simulation.cast_rays(walls, (0, 0, 0), angles, max_range=30.0), 50)
    yield Row("cast_rays, 682 beams against 200 walls", f"{1e3 * cast:.2f} ms", "< 1 ms")
    yield Row(
        "load malaga, 225 scans of 361 beams", f"{1e3 * seconds(lambda: load('malaga')):.0f} ms"
    )
    path = SHARED / "data" / "intel.log.gz"
    if not path.exists():
        yield from missing("read intel")
        return
    yield Row("read intel, 2672 scans of 180 beams", f"{1e3 * seconds(lambda: read(path)):.0f} ms")
