"""A scan of a laser that turned while the robot moved: its pose and the robot's motion in one."""

from __future__ import annotations

import math

import numpy as np

from ...arrays import Array
from ...poses.motions import arc, transform
from ._point_map import LAST, PointMap

#: How far the pose that is supposed may err, metres and radians: it counts where it is free.
POSE_ERRORS = 0.1, 0.1, 0.2
#: How far partners are sought at first, metres: a bent wall is a decimetre off.
BENT_REACH_M = 0.4
#: Partners are sought nearer after a step of less than this, metres, radians, radians a second.
NEAR_STEP = 0.1
#: A step of less than this is the last, in the same units.
LAST_STEP = 0.01
#: At most so many steps are made: most matches take 6.
MOST_STEPS = 20
#: Unknowns of a pose and a velocity.
POSE_AND_VELOCITY = 6
#: Unknowns of a pose, a velocity and an acceleration.
AND_ACCELERATION = 9
#: Unknowns of a pose, two velocities and the moment between them.
AND_JUMP = 10


def poses_at(motion: Array, since: Array) -> Array:
    """Where a motion `(7,)` leads in `(m,)` seconds: poses `(m, 3)`, metres and radians.

    The motion is a velocity, and its change: each second, or at once at a moment; that moment, NaN
    where it changes all the time. In the robot's frame, metres and radians, seconds.
    """
    return arc(since[:, None] * motion[:3] + _gain(motion[6], since)[:, None] * motion[3:6])


def _gain(at: float, since: Array) -> Array:
    """What a change of velocity adds in `(m,)` seconds, in its own unit, `(m,)`."""
    if np.isnan(at):
        return since**2 / 2
    return np.maximum(since - at, 0.0) - max(-at, 0.0)


def match_moving(
    map: PointMap,
    points: Array,
    since: Array,
    start: Array,
    motion: Array,
    errors: Array,
    unknowns: int,
) -> tuple[Array, Array]:
    """Pose `(3,)` and motion `(7,)` of a robot that moved while it measured, by point-to-line ICP.

    Points `(m, 2)`, in the frame of the robot, were measured `since`, `(m,)`, seconds after the
    pose; before it where negative. The offset of a point from its wall depends on the velocity as
    it does on the pose, times these seconds, and on its change, by what `poses_at` makes of it. The
    motion that is supposed errs by `errors`, `(7,)`: that counts where the walls tell little.
    """
    weight = np.r_[POSE_ERRORS, errors] ** -2.0
    supposed, reach = np.r_[start, motion], BENT_REACH_M
    state, free = supposed.copy(), slice(unknowns)
    for _ in range(MOST_STEPS):
        # 1. Each point carried to the moment of the pose, and its partner
        carried = transform(poses_at(state[3:], since), points[:, None])[:, 0]
        descent = map.descend(carried, state[:3], reach, LAST, stride=1, rounds=1)
        if len(descent.rows) < unknowns:
            break
        # 2. How its offset changes with pose, velocity, its change, and the moment of a jump
        by_pose, later = descent.rows[:, :3], since[descent.rows[:, 5].astype(np.int64)]
        c, s = math.cos(state[2]), math.sin(state[2])
        by_motion = by_pose @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        gain, at = _gain(state[9], later), state[9]
        by_moment = by_motion @ state[6:9] * ((at < 0) - 1.0 * (later > at))
        by_velocity = later[:, None] * by_motion, gain[:, None] * by_motion
        change = np.hstack([by_pose, *by_velocity, by_moment[:, None]])[:, free]
        # 3. A Gauss-Newton step
        weighed = change.T * (descent.rows[:, 4] / descent.sigma**2)
        slope = weighed @ descent.rows[:, 3] + (weight * (state - supposed))[free]
        step = np.linalg.solve(weighed @ change + np.diag(weight[free]), slope)
        state[free] -= step
        largest = np.abs(step[[0, 1, 2, 5]]).max()
        if unknowns == AND_JUMP:
            largest = max(largest, abs(step[8]), abs(state[8] * step[9]) / np.abs(since).max())
        if largest < LAST_STEP and reach <= LAST:
            break
        reach = max(reach / 2, LAST) if largest < NEAR_STEP else reach
    return state[:3], state[3:]
