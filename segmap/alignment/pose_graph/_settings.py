"""Thresholds of `pose_graph`: how scans are tracked, which loops are sought and believed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...arrays import Settings


@dataclass(frozen=True)
class Tracking(Settings):
    """How each scan is laid on the map of the last key frames.

    Parameters
    ----------
    frames : int
        Key frames of the local map: one holds too little of what the next scan sees.
    overlap : float
        Share of a scan's points that must lie on the map.
    sure : float
        Above this share nobody looks for a better place in twice the window.
    better, least : float
        A place in twice the window has to hold this much more of the scan, and at least this much.
    slide, slide_angle : float, metres and radians
        A descent that goes farther from where the search began is no match: it slides along walls.
    step_error, turn_error : float, metres and radians
        Standard deviations of the odometry between key frames where nothing matched.
    along_error : float, metres
        The same, along a direction that the walls of a match leave free.
    around : int, and near : float, metres
        At last each scan is laid on the map of so many key frames, within this distance.

    Raises
    ------
    ValueError
        For a value that is not positive, or a number that is not whole.
    """

    frames: int = 10
    overlap: float = 0.4
    sure: float = 0.7
    better: float = 0.1
    least: float = 0.6
    slide: float = 0.3
    slide_angle: float = 0.2
    step_error: float = 0.5
    turn_error: float = np.radians(20)
    along_error: float = 0.2
    around: int = 15
    near: float = 4.0


@dataclass(frozen=True)
class LoopClosing(Settings):
    """How loops are sought, and which of them are believed.

    Parameters
    ----------
    min_path : float, metres
        A loop is sought where the path since the old place is at least this long: before that the
        place is still on the local map.
    reach, max_reach : float, metres
        Half side of the search window about an old place, to which the share `drift` of the way is
        added up to the maximum: the shortest way through the graph, for what earlier loops have
        fixed cannot be far off.
    loop_path, vague : float, metres
        A believed loop is so long a part of that way, unless its standard deviation is larger than
        the second: along a corridor it fixes nothing.
    beside : float, metres
        Old places are proposed this much farther off than the window: they can be seen from there.
    turn : float, radians
        Half side of the window in heading.
    lost_reach : float, metres
        After a step that no match confirms the robot may be anywhere. The places that look most
        alike are then searched in this window at every heading ...
    lost_path : float, metres
        ... over a path of at most this length.
    old_frames, new_frames : int
        Key frames before and after the old one, and before the new one, whose points are compared:
        a single scan looks like many places. In windows of more than 2.5 m the old ones are those
        along as long a way: else the true place may lie where the map has ended.
    likelihood, overlap : float
        Mean likelihood, and share of the points with a partner, that a measured loop must reach.
    tolerance, angle : float, metres and radians
        Two loops agree where going round both leaves less than this.
    stretch : float, metres
        Only loops whose ends lie within this path of each other are compared: beyond it the error
        of the path itself would count.
    witnesses, lost_witnesses : int
        Number of other loops that must agree; more where the robot may be anywhere, since many
        rooms are built alike.
    span : float, metres
        A loop and its witnesses must lie along so long a path, or along one as long as the window's
        half side where that is less: what one door looks like, the next one does too.
    last_witnesses : int
        Number of loops that are enough when the log ends. Then loops of one scan to passes that lie
        farther apart than `stretch` count as well.
    strain, strain_angle : float, metres and radians
        The graph is solved at once where a new loop moves its ends by more than this.
    contradicted : float, standard deviations
        Loops that the solution leaves open by more are taken out at the end.

    Raises
    ------
    ValueError
        For a value that is not positive, or a number that is not whole.

    Examples
    --------
    >>> LoopClosing(witnesses=0)
    Traceback (most recent call last):
    ValueError: witnesses must be a number above 0, got 0
    """

    min_path: float = 10.0
    reach: float = 1.0
    max_reach: float = 12.0
    loop_path: float = 0.5
    vague: float = 0.2
    beside: float = 2.0
    turn: float = np.radians(20)
    lost_reach: float = 2.0
    lost_path: float = 15.0
    old_frames: int = 5
    new_frames: int = 3
    likelihood: float = 0.55
    overlap: float = 0.6
    tolerance: float = 0.25
    angle: float = np.radians(4)
    stretch: float = 8.0
    witnesses: int = 2
    lost_witnesses: int = 5
    span: float = 6.0
    last_witnesses: int = 1
    strain: float = 0.05
    strain_angle: float = np.radians(0.5)
    contradicted: float = 15.0
