"""The two greedy matchers, as B 4.3 says them; they climb any value of a pose."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from math import pi, radians
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from numpy.random import Generator

Pose = Sequence[float]
#: Six moves, in the order that decides between equals: x, y and heading.
MOVES = ((-1, 0, 0), (1, 0, 0), (0, -1, 0), (0, 1, 0), (0, 0, -1), (0, 0, 1))


def climb_step(
    value: Callable[[Pose], float],
    pose: Pose,
    move: float,
    turn: float,
    moves: Iterable[Pose] = MOVES,
) -> Pose:
    """The best of six small moves, or the pose itself where none improves its value (B 4.3.1)."""
    best, most = pose, value(pose)
    for x, y, heading in moves:
        tried = pose[0] + x * move, pose[1] + y * move, pose[2] + heading * turn
        if value(tried) > most:
            best, most = tried, value(tried)
    return best


def hill_climb(
    value: Callable[[Pose], float],
    start: Pose,
    *,
    sizes: Sequence[tuple[float, float]] = ((0.001, pi / 180),),
    rounds: int = 60,
) -> list[Pose]:
    """The start and all poses that a climb accepts: B moves by 1 mm or 1 degree (B 4.3.1).

    Each of the `sizes`, metres and radians, is used until none of its moves improves the value.

    Examples
    --------
    >>> len(hill_climb(lambda pose: pose[0], (0.0, 0.0, 0.0)))
    61
    """
    path = [start]
    for move, turn in sizes:
        while len(path) <= rounds:
            pose = climb_step(value, path[-1], move, turn)
            if pose is path[-1]:
                break
            path.append(pose)
    return path


def sample_and_rank(
    value: Callable[[Pose], float],
    start: Pose,
    *,
    rng: Generator,
    sigma: tuple[float, float] = (0.02, radians(2.0)),
) -> list[list[Pose]]:
    """Poses drawn in each round; the best of all is the answer (B 4.3.2).

    The start and 99 poses around it; then three times 4 poses around each of the best 20 so far.

    The spread `sigma` is in metres and radians; B's of the heading is 2 radians.

    Examples
    --------
    >>> import numpy as np
    >>> drawn = sample_and_rank(lambda p: -abs(p[0]), (0.1, 0, 0), rng=np.random.default_rng(1))
    >>> [len(poses) for poses in drawn]
    [100, 80, 80, 80]
    """

    def near(pose: Pose, part: float) -> Pose:
        spread = sigma[0] / part, sigma[0] / part, sigma[1] / part
        return tuple(at + rng.normal(0.0, away) for at, away in zip(pose, spread, strict=True))

    poses: list[Pose] = [tuple(start), *(near(start, 0.5) for _ in range(99))]
    rounds = [list(poses)]
    for k in (1, 2, 3):
        poses = sorted(poses, key=value, reverse=True)[:20]
        drawn = [near(pose, k) for pose in poses for _ in range(4)]
        poses += drawn
        rounds.append(drawn)
    return rounds
