"""Buildings of any size at one density: blocks with streets between them, no two places alike."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from .. import arrays
from ..arrays import Array, at_least, checked
from ..poses import transform
from ._rooms import Length, box, pose_at_start, recess, rectangular_room

#: One door, niche or pilaster stands in so many metres of a facade.
PITCH_M = 4.0
#: Widths of these, metres.
FEATURE_WIDTHS_M = (0.7, 1.6)
#: How deep they lie, metres: below 0 they stand out.
FEATURE_DEPTHS_M = (-0.3, 0.6)
#: Sides of the pillars before the facades, metres.
PILLARS = (0.2, 0.4)


@checked
def city(
    columns: int = 3,
    rows: int = 3,
    *,
    rng: np.random.Generator,
    block: Annotated[Length, at_least(PITCH_M)] = 16.0,
    street: Annotated[Length, at_least(2.5)] = 3.0,
) -> Array:
    """Square blocks with streets between and around them: a town, or the corridors of an office.

    Doors, niches, pilasters and pillars are drawn from the generator, so no two places are alike,
    and there are as many of them in a hundred square metres of a large city as of a small one. The
    middles of the streets are free for a robot: streets i and j cross at `street / 2 + (block +
    street) * (i, j)`.

    Parameters
    ----------
    columns, rows : int, at most 200
        Blocks along x and y.
    rng : numpy.random.Generator
        Draws everything that the facades hold.
    block : float
        Side of a block, at least 4 m.
    street : float
        Width of a street, at least 2.5 m.

    Returns
    -------
    (n, 2, 2) array, metres
        About a hundred walls a block.

    Examples
    --------
    >>> walls = city(2, 1, rng=np.random.default_rng(1), block=10, street=3)
    >>> bool(np.all(walls > -0.6)), bool(np.all(walls < (29.6, 16.6)))
    (True, True)
    """
    columns = arrays.whole(columns, "columns", most=200)
    rows = arrays.whole(rows, "rows", most=200)
    pitch = block + street
    around = rectangular_room(columns * pitch + street, rows * pitch + street)
    walls = [_facade(wall, rng) for wall in around]
    for corner in np.ndindex(columns, rows):
        middle = street + block / 2 + pitch * np.array(corner)
        for wall in box(block, block, (*middle, 0.0))[:, ::-1]:
            walls += [_facade(wall, rng), _pillar(wall, rng)]
    return np.asarray(np.round(np.concatenate(walls), 6))


def _facade(wall: Array, rng: np.random.Generator) -> Array:
    """A wall with something to its right, or left, in every four metres."""
    reach = float(np.hypot(*(wall[1] - wall[0])))
    count = int(reach // PITCH_M)
    cell = reach / count
    half = rng.uniform(*FEATURE_WIDTHS_M, count) / 2
    middle = cell * np.arange(count) + rng.uniform(half + 0.3, cell - half - 0.3)
    depth = rng.uniform(*FEATURE_DEPTHS_M, count)
    along = np.stack([middle - half, middle - half, middle + half, middle + half], -1).ravel()
    return recess(wall, along, np.stack([0 * depth, depth, depth, 0 * depth], -1).ravel())


def _pillar(wall: Array, rng: np.random.Generator) -> Array:
    """A pillar on the left of a wall, close to it."""
    reach = float(np.hypot(*(wall[1] - wall[0])))
    place = (rng.uniform(1.0, reach - 1.0), 0.35, rng.uniform(0, np.pi / 2))
    return transform(pose_at_start(wall), box(rng.uniform(*PILLARS), rng.uniform(*PILLARS), place))
