"""Poses: arrays `(..., 3)` of x, y in metres and heading in radians, counter-clockwise, x forward.

A pose is a frame and the motion that leads to it: `a_from_b` is the pose of b in the frame of a,
and carries points given in b into a. So `compose(a_from_b, b_from_c)` is `a_from_c`.
"""

from ._poses import (
    between,
    compose,
    interpolate,
    inverse,
    transform,
)

__all__ = ["between", "compose", "interpolate", "inverse", "transform"]
