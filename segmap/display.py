"""How scans, maps and reductions show themselves: their pictures, and a log in words."""

from __future__ import annotations

import base64
import re
from functools import singledispatch
from typing import Any

import numpy as np


class Pictured:
    """Gives an object its picture in a notebook, beside its `repr`.

    The picture comes from the function that is registered for its type in `picture`. Like every
    picture in a notebook file it is base64 text.
    """

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, Any]:
        png = base64.b64encode(picture(self)).decode("ascii")
        return {"text/plain": repr(self), "image/png": png}


@singledispatch
def picture(value: object) -> bytes:
    """A small PNG of an object.

    `segmap.plotting` registers a function for each type that it can draw; `segmap` registers one
    for all `Pictured` objects that first imports `segmap.plotting`. This room knows neither.
    """
    raise TypeError(f"no drawing is registered for {type(value).__name__}")


def pip_install(extra: str) -> str:
    """What to type where a package is missing that an extra of segmap brings.

    `pip install 'segmap[lab]'` would ask an index for a segmap; these packages stand there.

    Examples
    --------
    >>> pip_install("laser")
    'pip install pyserial'
    """
    from importlib.metadata import PackageNotFoundError, distributions, requires

    try:
        lines = requires("segmap") or []
    except PackageNotFoundError:  # sources on a path, which nobody installed
        return f"its packages are those of the extra {extra!r} in pyproject.toml"
    ours = [line for line in lines if line.endswith(f"extra == {extra!r}")]
    names = [re.split(r"[^\w.-]", line, maxsplit=1)[0] for line in ours]
    missing = [name for name in names if not any(distributions(name=name))]
    return " ".join(["pip install", *(missing or names)])


def counted(count: int, word: str) -> str:
    """A number and what it counts.

    Examples
    --------
    >>> counted(1, "scan"), counted(225, "scan")
    ('1 scan', '225 scans')
    """
    return f"{count} {word}{'s' * (count != 1)}"


def facts(log: Any) -> list[tuple[str, str]]:
    """What there is to know of a `Log` before anything is done with it, by words.

    Examples
    --------
    >>> from segmap import load
    >>> for fact in facts(load("malaga")):
    ...     print(*fact)  # doctest: +NORMALIZE_WHITESPACE
    scans 225 scans in 59.1 s, 4.34 a second
    beams 361 a scan, 88.5 % of them valid
    view 180 degrees, 0.5 from beam to beam
    ranges 0.79 to 49.82 m, half of them below 8.58 m, the sensor's limit is 50 m
    odometry for each scan; a path of 76.4 m, 12.3 m by 24.3 m
    truth for 99 of 225 scans; a path of 77.0 m, 14.2 m by 23.2 m
    assumed 361 beams look over 180 degrees, counter-clockwise; ranges from 50 m on
    met nothing, as those of a SICK
    """
    numbers = figures(log)
    rows = [("scans", counted(len(log), "scan") + _duration(log))]
    if len(log):
        rows += [("beams", _beams_text(**numbers["beams"])), ("view", _view_text(log))]
        rows += [("ranges", _ranges_text(log, **numbers.get("ranges", {})))]
    if spans := [np.ptp(scan.delays) for scan in log if scan.delays is not None and len(scan)]:
        order = "" if log.order_known else ", in an order that is not known"
        rows.append(("delays", f"the beams take {np.median(spans):.3g} s{order}"))
    rows += [
        (word, _path_text(getattr(log, word), **numbers[word])) for word in ("odometry", "truth")
    ]
    if log.assumed:
        rows.append(("assumed", "; ".join(log.assumed)))
    if damage := log.skipped:
        rows.append(("damaged", f"{counted(damage.lines, 'line')} left out; {damage.reason}"))
    return rows


def figures(log: Any) -> dict[str, dict[str, float]]:
    """The numbers of a `Log` by the words of `facts`: counts, metres, seconds, degrees, shares.

    What a log does not tell is left out.

    Examples
    --------
    >>> from segmap import load
    >>> figures(load("malaga"))["view"]
    {'degrees': 180.0, 'step_degrees': 0.5}
    """
    numbers: dict[str, dict[str, float]] = {"scans": {"scans": len(log)}}
    times = log.times[np.isfinite(log.times)]
    if len(times) > 1 and np.ptp(times):
        numbers["scans"]["seconds"] = float(np.ptp(times))
    for word, poses in (("odometry", log.odometry), ("truth", log.truth)):
        path = np.zeros((0, 3)) if poses is None else poses[np.isfinite(poses).all(1)]
        way = float(np.hypot(*np.diff(path[:, :2], axis=0).T).sum())
        numbers[word] = {"poses": len(path), "metres": way}
    if log.skipped:
        numbers["damaged"] = {"lines": log.skipped.lines}
    if not len(log):
        return numbers
    counts = [len(scan) for scan in log]
    valid = np.concatenate([scan.ranges[scan.valid] for scan in log])
    share = len(valid) / max(sum(counts), 1)
    numbers["beams"] = {"least": min(counts), "most": max(counts), "valid": share}
    if len(valid):
        near, half, far = np.quantile(valid, [0, 0.5, 1]).tolist()
        numbers["ranges"] = {"nearest": near, "median": half, "farthest": far}
    angles = max(log, key=len).angles
    if len(angles) > 1:
        wide, step = np.degrees([np.ptp(angles), np.median(np.abs(np.diff(angles)))]).tolist()
        numbers["view"] = {"degrees": round(wide, 9), "step_degrees": round(step, 9)}
    return numbers


def _duration(log: Any) -> str:
    times = log.times[np.isfinite(log.times)]
    if len(times) < 2 or not np.ptp(times):
        return ", without times"
    steps = np.diff(times)
    rate = f", {1 / np.median(steps):.3g} a second" if np.median(steps) > 0 else ""
    back = int((steps < 0).sum())
    early = f", {counted(back, 'time')} earlier than the one before" if back else ""
    return f" in {np.ptp(times):.1f} s{rate}{early}"


def _beams_text(least: float, most: float, valid: float) -> str:
    many = f"{least}" if least == most else f"{least} to {most}"
    return f"{many} a scan, {100 * valid:.1f} % of them valid"


def _view_text(log: Any) -> str:
    scan = max(log, key=len)
    places = {tuple(scan.sensor_pose) for scan in log}
    lasers = "" if len(places) == 1 else f", {counted(len(places), 'laser')}"
    if len(scan) < 2:
        return f"{counted(len(scan), 'beam')}{lasers}"
    wide, step = np.ptp(scan.angles), np.median(np.abs(np.diff(scan.angles)))
    return f"{np.degrees(wide):.4g} degrees, {np.degrees(step):.3g} from beam to beam{lasers}"


def _ranges_text(log: Any, nearest: float = 0.0, median: float = 0.0, farthest: float = 0.0) -> str:
    if not farthest:
        return "none is valid"
    limits = {f"{scan.max_range:.4g}" for scan in log if np.isfinite(scan.max_range)}
    limit = f", the sensor's limit is {limits.pop()} m" if len(limits) == 1 else ""
    return f"{nearest:.2f} to {farthest:.2f} m, half of them below {median:.2f} m{limit}"


def _path_text(all_poses: Any, poses: float, metres: float) -> str:
    if not poses:
        return "none"
    wide, tall = np.ptp(all_poses[np.isfinite(all_poses).all(1), :2], axis=0)
    share = "each scan" if poses == len(all_poses) else f"{poses} of {len(all_poses)} scans"
    return f"for {share}; a path of {metres:.1f} m, {wide:.1f} m by {tall:.1f} m"
