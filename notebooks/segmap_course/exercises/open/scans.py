"""Open exercises on beams, odometry and readers."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np

from segmap.arrays import Array
from segmap.poses import compose
from segmap.readers import read
from segmap.simulation import cast_rays

from ._open import Challenge, Prediction


# ----------------------------------------------------------- beams, odometry and readers
def _beams_on_wall() -> float:
    wall = [[(4.0, -0.5), (4.0, 0.5)]]
    ranges = cast_rays(wall, (0, 0, 0), np.radians(np.arange(-90, 91)), max_range=10.0)
    return float(np.isfinite(ranges).sum())


predict_beams_on_wall = Prediction(
    "predict_beams_on_wall(guess): how many of 181 beams, one a degree from -90 to 90, meet a wall "
    "of 1 m that stands square to the sensor, 4 m straight ahead; within 1 beam",
    _beams_on_wall,
    "beams",
    within=1,
    because="The wall is 2 atan(0.5 / 4) = 14.25 degrees wide; one beam looks straight ahead",
)


def _drift() -> float:
    believed = np.zeros(3)
    for _ in range(100):
        believed = compose(believed, (1.0, 0.0, np.radians(0.1)))
    return float(np.hypot(*(believed[:2] - (100, 0))))


predict_drift = Prediction(
    "predict_drift(guess): a robot drives 100 m straight ahead, in steps of 1 m, and its wheels "
    "report a turn of 0.1 degrees too much in each step; how many metres is the place where it "
    "believes to be from the place where it is; within a factor of 1.3",
    _drift,
    "m",
    factor=1.3,
    because="The heading is off by 10 degrees at the end and by 5 degrees, 0.087 rad, on average; "
    "100 m times 0.087 is nearly that. On twice the way it is four times as much",
)


def _reread(ranges: Array) -> Array:
    """What the reader makes of ranges `(n,)`, metres, in a line of CARMEN's format."""
    line = " ".join(["FLASER", str(len(ranges)), *(f"{r:.2f}" for r in ranges), "0 0 0 " * 2])
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "break.log"
        path.write_text(f"{line}12.5 robot 0.0\n")
        return np.asarray(read(path)[0].ranges)


def _reader_fooled(ranges: Array) -> str:
    if ranges.ndim != 1 or not 3 <= len(ranges) <= 361:
        raise ValueError(f"give 3 to 361 ranges, (n,) in metres, got shape {ranges.shape}")
    if ranges.min() < 0.1 or ranges.max() > 30:
        raise ValueError("the walls of this building are 0.1 to 30 m away")
    lost = int(np.isinf(_reread(ranges)).sum())
    needed = (len(ranges) + 1) // 2
    return "" if lost >= needed else f"{lost} of {len(ranges)} walls are lost, {needed} are wanted"


break_reader = Challenge(
    "break_reader(ranges): the true ranges, (n,) in metres, of a scan of 3 to 361 beams; all of "
    "them have met a wall, 0.1 to 30 m away; the reader of CARMEN's format takes at least half of "
    "them for beams that met nothing",
    _reader_fooled,
    praise="The reader guesses the measuring mode from the largest range of the log; a log that "
    "happens to end at 8.2 m looks like one of a sensor that sees no farther",
)
