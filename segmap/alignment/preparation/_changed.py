"""A log that is put right: other values in fields of its scans, and what was found."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ...arrays import Array
from ...scans import Log
from ...scans.causes import Finding


def with_fields(log: Log, *findings: Finding, **columns: Iterable[Any]) -> Log:
    """A log whose scans have other values of some fields, one a scan in each column; and why."""
    rows = (dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True))
    scans = tuple(replace(scan, **row) for scan, row in zip(log, rows, strict=True))
    return replace(log, scans=scans, causes=(*log.causes, *findings))


def with_odometry_rows(log: Log, rows: Array, *findings: Finding, **columns: Iterable[Any]) -> Log:
    """A log with other odometry `(k, 3)`, NaN where there is none; and why."""
    odometry = (row if np.isfinite(row).all() else None for row in rows)
    return with_fields(log, *findings, odometry=odometry, **columns)


def with_beams(log: Log, beams: Iterable[ArrayLike], m: float, *findings: Finding) -> Log:
    """A log where some beams, `(n,)` of each scan, have a range of m metres; and why."""
    ranges = (np.where(some, m, scan.ranges) for scan, some in zip(log, beams, strict=True))
    return with_fields(log, *findings, ranges=ranges)
