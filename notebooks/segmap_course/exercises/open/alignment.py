"""Open exercises on ICP: how far it drifts, and an offset that it is sure of wrongly."""

from __future__ import annotations

import numpy as np

from segmap.alignment import match_points, point_icp, position_errors
from segmap.arrays import Array
from segmap.poses import between
from segmap.readers import load

from ._open import Challenge, Prediction


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
    match = match_points(log[20].points(), log[22].points(), true + offset)
    if not match.matched:
        return f"it says so: {match.reason}"
    spread = float(np.sqrt(np.trace(match.covariance[:2, :2])))
    if match.free is not None or spread > sure:
        return f"it is not sure: it may be {spread:.2f} m off, {sure:g} m is wanted"
    off = float(np.hypot(*between(true, match.pose)[:2]))
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
