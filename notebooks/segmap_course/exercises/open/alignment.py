"""Open exercises of parts 3, 4 and 7: ICP, quality, and the sums of the laser's protocol."""

from __future__ import annotations

import numpy as np

from segmap.alignment import match_points, point_icp, position_errors
from segmap.arrays import Array
from segmap.metrics import quality
from segmap.poses import between
from segmap.readers import load
from segmap.sensors import checksum, decode

from ._open import ROOM, Challenge, Prediction, admit, metres_away


# ---------------------------------------------------------------------------- ICP
def _sparse_icp() -> float:
    log = load("malaga")[1::6]
    assert log.truth is not None
    return float(position_errors(point_icp(log).poses, log.truth)[-1])


predict_sparse_icp = Prediction(
    "predict_sparse_icp(guess): `alignment.point_icp` is given every sixth scan of Malaga, "
    '`segmap.load("malaga")[1::6]`; how many metres is the last scan off in the end, as '
    "`alignment.position_errors` measures it; within 0.15 m",
    _sparse_icp,
    "m",
    within=0.15,
    because="Every scan still starts within the basin, so nothing is lost. With every eighth a "
    "scan starts outside of it, and the end is 1.8 m off: an error of ICP does not grow step by "
    "step, it jumps",
)


def _icp_fooled(*parts: Array, far: float = 1.0, sure: float = 0.1) -> str:
    offset = np.concatenate([part.ravel() for part in parts])
    if offset.shape != (3,):
        raise ValueError(f"give x, y in metres and a turn in radians, (3,), got {offset.shape}")
    if np.hypot(*offset[:2]) > 1 or abs(offset[2]) > np.radians(30):
        raise ValueError("stay within 1 m and 30 degrees (0.52 rad) of the true pose")
    log = load("corridor")
    assert log.truth is not None
    true = between(log.truth[20], log.truth[22])
    found = match_points(log[20].points(), log[22].points(), true + offset)
    if not found.matched:
        return f"it says so: {found.reason}"
    spread = float(np.sqrt(np.trace(found.covariance[:2, :2])))
    if found.free is not None or spread > sure:
        return f"it is not sure: it may be {spread:.2f} m off, {sure:g} m is wanted"
    off = float(np.hypot(*between(true, found.pose)[:2]))
    return "" if off >= far else f"it is {off:.3f} m off, {far:g} m are wanted"


break_icp = Challenge(
    "break_icp(offset): x, y in metres and a turn in radians, (3,), at most 1 m and 30 degrees; "
    'scan 22 of `segmap.load("corridor")` is matched with scan 20 by `alignment.match_points`, '
    "from the true pose plus this offset; the match is at least 1 m wrong, leaves no direction "
    "free, and claims a standard deviation below 0.1 m",
    _icp_fooled,
    praise="A wrong valley has a bottom too, and the covariance describes that bottom; the overlap "
    "is half of what it should be",
)


# ---------------------------------------------------------------------------- quality
def _quality_fooled(after: Array) -> str:
    admit(after, "segments", 1, 50, of="the room's corner")
    found, metres = quality(ROOM, after), metres_away(after, ROOM, 0.5)
    if found < 0.95:
        return f"the quality sees it: {found:.3f}, 0.95 is wanted"
    return "" if metres >= 5 else f"only {metres:.1f} m of walls are invented, 5 m are wanted"


break_quality = Challenge(
    "break_quality(after): a map `after`, (n, 2, 2) in metres, of up to 50 segments within 20 m, "
    "that has a quality of at least 0.95 against the walls of `simulation.rectangular_room()`, "
    "though 5 m of its walls stand farther than 0.5 m from all of them",
    _quality_fooled,
    praise="The quality asks where the walls of the map before went, not where those after it come "
    "from: what is invented costs nothing",
)


# ---------------------------------------------------------------------------- the laser's line
predict_scan_time = Prediction(
    "predict_scan_time(guess): how many milliseconds a scan of 2134 bytes takes over a serial line "
    "of 115 200 bit/s; within a factor of 1.1",
    lambda: 1000 * 2134 * 10 / 115200,
    "ms",
    factor=1.1,
    because="A byte takes ten bits on the line, with its start and stop bit. Ten scans a second "
    "need 100 ms or less",
)


def _sum_fooled(sent: Array, received: Array, most: float = 1000.0) -> str:
    for name, block in (("sent", sent), ("received", received)):
        if block.shape != (63,) or (block != block.round()).any():
            raise ValueError(f"{name}: give 63 whole numbers, the characters of 21 distances")
        if block.min() < 0x30 or block.max() > 0x6F:
            raise ValueError(f"{name}: characters lie between 0x30 and 0x6f")
    first, second = (block.astype(np.uint8) for block in (sent, received))
    flipped = int(np.unpackbits(first ^ second).sum())
    if flipped > 2:
        raise ValueError(f"at most two bits may be wrong, these are {flipped}")
    if checksum(first.tobytes()) != checksum(second.tobytes()):
        return "the sum sees it"
    wrong = np.abs(decode(first.tobytes(), 3) - decode(second.tobytes(), 3)).max()
    return "" if wrong >= most else f"no distance is off by more than {wrong:.0f} mm, 1 m is wanted"


break_sum = Challenge(
    "break_sum(sent, received), given as one pair: 63 characters each, as numbers from 0x30 to "
    "0x6f, that stand for 21 distances of three characters; at most two bits differ, the sums of "
    "both are equal, and a distance is wrong by at least 1 m",
    _sum_fooled,
    praise="A sum of six bits sees every single error, and misses some of two; a check that "
    "depends on the order, such as a CRC, would see these as well",
)
