"""How scans, maps and reductions show themselves: their pictures, and a log in words."""

from __future__ import annotations

import base64
import re
from functools import singledispatch
from typing import Any, NamedTuple

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
    for all `Pictured` objects that first imports `segmap.plotting`. This module imports neither.
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


def plural(count: int, word: str) -> str:
    """A number and what it counts.

    Examples
    --------
    >>> plural(1, "scan"), plural(225, "scan")
    ('1 scan', '225 scans')
    """
    return f"{count} {word}{'s' * (count != 1)}"


class Fact(NamedTuple):
    """A thing that is known of a log: in words, and its numbers."""

    word: str
    text: str
    numbers: dict[str, float]  #: counts, metres, seconds, degrees, shares; without what is not told


def facts(log: Any) -> list[Fact]:
    """What there is to know of a `Log` before anything is done with it.

    Examples
    --------
    >>> from segmap import load
    >>> for fact in facts(load("malaga")):
    ...     print(fact.word, fact.text)  # doctest: +NORMALIZE_WHITESPACE
    scans 225 scans in 59.1 s, 4.34 a second
    beams 361 a scan, 88.5 % of them valid
    view 180 degrees, 0.5 from beam to beam
    ranges 0.79 to 49.82 m, half of them below 8.58 m, the sensor's limit is 50 m
    odometry for each scan; a path of 76.4 m, 12.3 m by 24.3 m
    truth for 99 of 225 scans; a path of 77.0 m, 14.2 m by 23.2 m
    assumed 361 beams look over 180 degrees, counter-clockwise; ranges from 50 m on
    met nothing, as those of a SICK
    """
    rows = [_scans(log)]
    if len(log):
        rows += [_beams(log), _view(log), _ranges(log)]
    if spans := [np.ptp(scan.delays) for scan in log if scan.delays is not None and len(scan)]:
        order = "" if log.order_known else ", in an order that is not known"
        rows.append(Fact("delays", f"the beams take {np.median(spans):.3g} s{order}", {}))
    rows += [_path("odometry", log.odometry), _path("truth", log.truth)]
    if log.assumed:
        rows.append(Fact("assumed", "; ".join(log.assumed), {}))
    if damage := log.skipped:
        text = f"{plural(damage.lines, 'line')} left out; {damage.reason}"
        rows.append(Fact("damaged", text, {"lines": damage.lines}))
    return rows


def _scans(log: Any) -> Fact:
    times, count = log.times[np.isfinite(log.times)], plural(len(log), "scan")
    if len(times) < 2 or not np.ptp(times):
        return Fact("scans", f"{count}, without times", {"scans": len(log)})
    steps, seconds = np.diff(times), float(np.ptp(times))
    rate = f", {1 / np.median(steps):.3g} a second" if np.median(steps) > 0 else ""
    back = int((steps < 0).sum())
    early = f", {plural(back, 'time')} earlier than the one before" if back else ""
    text = f"{count} in {seconds:.1f} s{rate}{early}"
    return Fact("scans", text, {"scans": len(log), "seconds": seconds})


def _beams(log: Any) -> Fact:
    counts = [len(scan) for scan in log]
    valid = sum(int(scan.valid.sum()) for scan in log) / max(sum(counts), 1)
    least, most = min(counts), max(counts)
    many = f"{least}" if least == most else f"{least} to {most}"
    text = f"{many} a scan, {100 * valid:.1f} % of them valid"
    return Fact("beams", text, {"least": least, "most": most, "valid": valid})


def _view(log: Any) -> Fact:
    scan, places = max(log, key=len), {tuple(scan.sensor_pose) for scan in log}
    lasers = "" if len(places) == 1 else f", {plural(len(places), 'laser')}"
    if len(scan) < 2:
        return Fact("view", f"{plural(len(scan), 'beam')}{lasers}", {})
    steps = np.abs(np.diff(scan.angles))
    wide, step = np.degrees([np.ptp(scan.angles), np.median(steps)]).tolist()
    text = f"{wide:.4g} degrees, {step:.3g} from beam to beam{lasers}"
    return Fact("view", text, {"degrees": round(wide, 9), "step_degrees": round(step, 9)})


def _ranges(log: Any) -> Fact:
    ranges = np.concatenate([scan.ranges[scan.valid] for scan in log])
    if not len(ranges):
        return Fact("ranges", "none is valid", {})
    near, half, far = np.quantile(ranges, [0, 0.5, 1]).tolist()
    limits = {f"{scan.max_range:.4g}" for scan in log if np.isfinite(scan.max_range)}
    limit = f", the sensor's limit is {limits.pop()} m" if len(limits) == 1 else ""
    text = f"{near:.2f} to {far:.2f} m, half of them below {half:.2f} m{limit}"
    return Fact("ranges", text, {"nearest": near, "median": half, "farthest": far})


def _path(word: str, poses: Any) -> Fact:
    count = 0 if poses is None else len(poses)
    path = np.zeros((0, 2)) if poses is None else poses[np.isfinite(poses).all(1), :2]
    way = float(np.hypot(*np.diff(path, axis=0).T).sum())
    text = "none"
    if len(path):
        wide, tall = np.ptp(path, axis=0)
        share = "each scan" if len(path) == count else f"{len(path)} of {count} scans"
        text = f"for {share}; a path of {way:.1f} m, {wide:.1f} m by {tall:.1f} m"
    return Fact(word, text, {"poses": len(path), "metres": way})
