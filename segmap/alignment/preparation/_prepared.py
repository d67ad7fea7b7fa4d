"""From a log as it was read to one that can be aligned."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from ... import arrays
from ...arrays import Array, checked
from ...poses.motions import compose, inverse
from ...progress import Progress
from ...scans import Log
from ...scans.odometry import odometry_against_steps
from .. import _deskew
from ._blind_steps import blind_steps
from ._body import without_body
from ._changed import with_beams, with_fields
from ._clock import with_clock_mended, with_readings_spread, with_waiting_scans_spread
from ._nothing_met import without_limit, without_nothing_met
from ._odometry import mounting_of, with_odometry_corrected
from ._range_unit import with_ranges_in_metres


@checked
def prepared(
    log: Log,
    *,
    deskew: bool = True,
    keep_body: bool = False,
    mask: ArrayLike | None = None,
    clockwise: bool = False,
    mount: ArrayLike | Literal["auto"] | None = None,
    progress: Progress | None = None,
) -> Log:
    """Correct beams, clock and odometry of a log by the log itself, and report each fault in it.

    1. If the clock jumps back, later times are shifted so that they increase. If all times are
       equal, they are removed. Scans that waited for the recorder are spread over its pause. Ranges
       of kilometres are in another unit; one number in many beams means that nothing was met.
    2. Beams that see what rides with the robot are left out.
    3. Odometry is interpolated between readings that are rarer than scans, and compared with
       matches that do not use it. Another unit, delay or direction is corrected, a jump does not
       count as motion, and odometry that contradicts the scans is left out.
    4. Beams of a laser that turns while the robot moves are carried back: `alignment.deskew`.

    Parameters
    ----------
    deskew
        False takes all beams of a scan to be measured at once.
    keep_body
        True keeps beams that see the robot itself.
    mask : (m, 2) array, radians, or None
        Directions that see the robot, from .. to counter-clockwise in the laser's frame: what is
        measured there is left out.
    clockwise
        The beams are measured, or listed, the other way round: a laser that hangs upside down.
    mount : (3,) array, metres and radians, "auto" or None
        Pose of the laser on the robot; "auto" estimates it from the robot's turns and ways. None
        leaves it as the log has it.
    progress
        As in `pose_graph`.

    Returns
    -------
    Log
        The same object where nothing is wrong. `causes` lists the faults; every alignment of the
        log has them too.

    Examples
    --------
    >>> from dataclasses import replace
    >>> from segmap import load
    >>> log = load("corridor")
    >>> feet = [replace(scan, odometry=scan.odometry * (3.2808, 3.2808, 1)) for scan in log]
    >>> prepared(replace(log, scans=tuple(feet))).doubt
    'the odometry is in feet: converted'
    """
    arrays.instance(log, "log", Log)
    if clockwise:
        log = with_fields(log, angles=[-scan.angles for scan in log])
    if mask is not None:
        log = _mask(log, arrays.table(mask, "mask", 2, unit="radians", limit=2 * np.pi))
    if mount is not None and not isinstance(mount, str):
        log = with_fields(log, sensor_pose=[arrays.pose(mount, "mount")] * len(log))
    log = with_waiting_scans_spread(with_clock_mended(log))
    log = with_ranges_in_metres(without_nothing_met(log))
    steps = blind_steps(log)
    if not keep_body and (seen := without_body(log, steps)) is not log:
        log, steps = seen, blind_steps(seen)
    if (seen := without_limit(log, steps)) is not log:
        log, steps = seen, blind_steps(seen)
    log = with_readings_spread(log, steps)
    if isinstance(mount, str):
        arrays.one_of(mount, "mount", ["auto"])
        place = mounting_of(odometry_against_steps(log.odometry, steps))
        log = with_fields(log, sensor_pose=[compose(place, scan.sensor_pose) for scan in log])
        steps = steps._replace(motion=compose(compose(place, steps.motion), inverse(place)))
    log = with_odometry_corrected(log, steps)
    return _deskew.deskew(log) if deskew else log


def _mask(log: Log, mask: Array) -> Log:
    """A log with NaN from the first direction of each row `(m, 2)`, radians, to the second."""
    width = np.diff(mask, axis=1)[:, 0] % (2 * np.pi)
    if not (width > 0).all():
        raise ValueError(f"mask must hold directions from .. to that differ, got {mask.tolist()}")
    inside = (((s.angles[:, None] - mask[:, 0]) % (2 * np.pi) <= width).any(1) for s in log)
    return with_beams(log, inside, np.nan)
