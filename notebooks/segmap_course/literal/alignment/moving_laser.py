"""A laser that turns while the robot moves: each beam carried to the start of its scan, by hand."""

from __future__ import annotations

import math
from collections.abc import Sequence

Pose = Sequence[float]


def steady_twist(motion: Pose, seconds: float) -> tuple[float, float, float]:
    """Speeds ahead, aside and of turning that lead to a pose in some seconds, all the way alike.

    Examples
    --------
    >>> steady_twist((2, 2, math.pi / 2), 1)  # a quarter of a circle of radius 2
    (3.141592653589793, 0.0, 1.5707963267948966)
    """
    x, y, turn = motion
    if turn == 0:
        return x / seconds, y / seconds, 0.0
    half = turn / 2
    ahead = half * (x / math.tan(half) + y)
    aside = half * (y / math.tan(half) - x)
    return ahead / seconds, round(aside / seconds, 15) + 0.0, turn / seconds


def after(twist: Pose, seconds: float) -> tuple[float, float, float]:
    """Where a robot is after some seconds of a steady twist, seen from where it was.

    It drives round a point that stands still: on its left where it turns left.
    """
    ahead, aside, rate = twist
    turn = rate * seconds
    if turn == 0:
        return ahead * seconds, aside * seconds, 0.0
    x = (ahead * math.sin(turn) - aside * (1 - math.cos(turn))) / rate
    y = (aside * math.sin(turn) + ahead * (1 - math.cos(turn))) / rate
    return x, y, turn


def carry_beam(
    distance: float, angle: float, delay: float, twist: Pose, sensor: Pose = (0, 0, 0)
) -> tuple[float, float]:
    """Range and direction that a beam would have had at the start of its scan.

    `twist` is how the robot moves, metres and radians a second; `sensor` where the laser sits on
    it.

    Examples
    --------
    >>> carry_beam(3.0, 0.0, 0.1, (1.0, 0.0, 0.0))  # it was 10 cm farther from the wall ahead
    (3.1, 0.0)
    """
    # 1. The end point, seen from the robot when the beam was measured
    seen = angle + sensor[2]
    x = sensor[0] + distance * math.cos(seen)
    y = sensor[1] + distance * math.sin(seen)
    # 2. Seen from the robot at the start of the scan
    moved_x, moved_y, turned = after(twist, delay)
    x, y = (
        moved_x + x * math.cos(turned) - y * math.sin(turned),
        moved_y + x * math.sin(turned) + y * math.cos(turned),
    )
    # 3. Seen from the laser at the start of the scan
    x, y = x - sensor[0], y - sensor[1]
    direction = math.atan2(y, x) - sensor[2]
    while direction < angle + turned - math.pi:  # the direction may be beyond half a turn
        direction += 2 * math.pi
    while direction > angle + turned + math.pi:
        direction -= 2 * math.pi
    return math.hypot(x, y), direction
