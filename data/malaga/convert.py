"""Convert the Malaga loop from MRPT's binary files into one CARMEN log.

    python convert.py RAWLOG SIMPLEMAP malaga.log.gz

RAWLOG holds all scans and the odometry between them, SIMPLEMAP some of the scans with corrected
poses of the robot. What is in such files, `segmap/readers/mrpt/_mrpt.py` tells; `readers.read`
reads each of them alone.
"""

import gzip
import sys
from pathlib import Path

import numpy as np

from segmap.poses import compose
from segmap.readers.mrpt import _mrpt

#: Ranges from here on, metres, are the sensor's codes for nothing met; they are kept.
NO_RETURN = 80.0


def checked(path: Path) -> list[_mrpt.Turn]:
    """All turns of the laser in a file, whose flags of validity say the same as the ranges."""
    recording = _mrpt.recorded(path)
    turns = recording.turns
    if recording.skipped or any((turn.valid != (turn.ranges < NO_RETURN)).any() for turn in turns):
        raise ValueError("expected scans alone, whose beams are valid where they met something")
    if any((turn.place != (turns[0].place[0], 0, 0)).any() for turn in turns):
        raise ValueError("expected one place of the laser, ahead of the robot's turning point")
    return turns


def line(turn: _mrpt.Turn, laser: np.ndarray, start: float) -> str:
    """One FLASER line."""
    fields = [f"{r:.2f}" for r in turn.ranges]
    fields += [f"{v:.6f}" for v in (*laser, *turn.odometry, turn.time)]
    return f"FLASER {len(turn.ranges)} {' '.join(fields)} malaga {turn.time - start:.6f}"


def convert(rawlog: Path, simple_map_file: Path) -> str:
    """The log as text."""
    turns, corrected = checked(rawlog), {turn.time: turn for turn in checked(simple_map_file)}
    place = turns[0].place
    lines = [f"PARAM robot_frontlaser_offset {place[0]:.6f}"]
    for turn in turns:
        known = corrected.pop(turn.time, turn)
        if not np.array_equal(known.ranges, turn.ranges) or (known.place != place).any():
            raise ValueError("expected the same ranges and the same laser in both files")
        lines.append(line(turn, compose(known.truth, place), turns[0].time))
    if corrected:
        raise ValueError("expected each corrected pose to have its scan")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    text = convert(Path(sys.argv[1]), Path(sys.argv[2]))
    Path(sys.argv[3]).write_bytes(gzip.compress(text.encode("ascii"), mtime=0))
