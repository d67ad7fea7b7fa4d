"""The building of the story: a clinic, and a person with a wardrobe who asks three things."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from segmap import arrays
from segmap.arrays import Array, Segments
from segmap.poses import between, compose
from segmap.readers import data_file, load, read_segments
from segmap.simulation import cast_rays

#: The wardrobe.
WARDROBE_LENGTH_M = 2.0
WARDROBE_DEPTH_M = 0.6
#: From where a tape is stretched to one wall, and from where to the other: true poses, m and rad.
TAPES = {
    "left corridor": ((0.6, 6.5, np.pi), (0.6, 6.5, 0.0)),
    "upper corridor": ((1.5, 8.1, -np.pi / 2), (1.5, 8.1, np.pi / 2)),
    "wall": ((6.55, 2.4, np.pi), (4.4, 2.4, 0.0)),
    "building": ((4.4, 0.7, np.pi), (4.4, 0.7, 0.0)),
}
#: Each tape is held at nine places side by side: this far from the robot, to its left.
ASIDE_M = np.linspace(-0.2, 0.2, 9)
#: A tape is read to so much: no deviation is smaller.
READING_M = 0.001
#: An answer is sure where it is more than so many of its deviations away from nothing.
SURE_DEVIATIONS = 2.0
#: Turns of the wardrobe on its way round the corner, radians.
TURNS = np.linspace(0, np.pi / 2, 901)


class Measured(NamedTuple):
    """The middle one of nine lengths, and half of what the middle seven span or more: metres."""

    metres: float
    deviation: float

    @property
    def sure(self) -> bool:
        """Whether it is more than two deviations away from 0; no for a wall that was not seen."""
        return bool(abs(self.metres) > SURE_DEVIATIONS * self.deviation)


@dataclass(frozen=True)
class Answers:
    """What a map says about the clinic; nothing in it knows how far the map is from the truth.

    `clearance` is what is left for the wardrobe where it is tightest, at `turn` radians: below 0 it
    is stuck. `wall` is the thickness between rooms 2 and 3, `building` the length from end wall to
    end wall. `tapes` are the corridors, and `ends` of the middle tape of each, `(2, 2)`, metres.
    """

    clearance: Measured
    wall: Measured
    building: Measured
    turn: float = field(repr=False)
    tapes: dict[str, Measured] = field(repr=False)
    ends: dict[str, Array] = field(repr=False)

    def __repr__(self) -> str:
        return f"wardrobe {self.of_wardrobe}; wall {self.of_wall}; building {self.of_building}"

    @property
    def of_wardrobe(self) -> str:
        """Whether the wardrobe goes round the corner, in words."""
        clearance, size = self.clearance, _centimetres(self.clearance)
        if not clearance.sure:
            return f"cannot be told ({size})"
        return f"goes round: {size} to spare" if clearance.metres > 0 else f"is stuck: {size}"

    @property
    def of_wall(self) -> str:
        """How thick the wall is, in words."""
        seen, size = self.wall.sure and self.wall.metres > 0, _centimetres(self.wall)
        return size if seen else f"cannot be told ({size})"

    @property
    def of_building(self) -> str:
        """How long the building is, in words."""
        metres, deviation = self.building
        size = f"{metres:.2f} ± {deviation:.2f} m" if np.isfinite(deviation) else "not seen"
        return size if self.building.sure and metres > 0 else f"cannot be told ({size})"


def _centimetres(length: Measured) -> str:
    if not np.isfinite(length.deviation):
        return "a wall was not seen"
    metres, deviation = (100 * np.array(length)).round(1) + 0.0  # no -0.0
    return f"{metres:.1f} ± {deviation:.1f} cm"


def clinic_walls() -> Array:
    """The true walls of the building in which the bundled log `clinic` was driven, `(n, 2, 2)`, m.

    Examples
    --------
    >>> clinic_walls().max(axis=(0, 1))
    array([9. , 8.8])
    """
    return read_segments(data_file("clinic/walls.csv")).segments


def clearance_at(first: ArrayLike, second: ArrayLike, turn: ArrayLike) -> Array:
    """How far the inner corner between two corridors is from the wardrobe at a turn, metres.

    That is `w1 cos t + w2 sin t - L sin t cos t - b`: its ends touch the outer walls, and t, in
    radians, is 0 along the first corridor.

    Examples
    --------
    >>> clearance_at(1.2, 1.3, 0)
    array(0.6)
    """
    (w1, w2), t = (np.asarray(width, float) for width in (first, second)), np.asarray(turn, float)
    sin, cos = np.sin(t), np.cos(t)
    return np.asarray(w1 * cos + w2 * sin - WARDROBE_LENGTH_M * sin * cos - WARDROBE_DEPTH_M)


def clearance(first: ArrayLike, second: ArrayLike) -> tuple[Array, Array]:
    """Room that is left for the wardrobe between corridors of two widths, and the tightest turn.

    Metres and radians.

    Examples
    --------
    >>> metres, turn = clearance(1.2, 1.3)
    >>> round(float(metres), 3), round(float(np.degrees(turn)))
    (0.167, 43)
    """
    w1, w2 = (np.asarray(width, float)[..., None] for width in (first, second))
    room = clearance_at(w1, w2, TURNS)
    return room.min(axis=-1), TURNS[room.argmin(axis=-1)]


def measure_clinic(map: Segments, poses: ArrayLike | None = None) -> Answers:
    """Measure the clinic with a tape on a map of it.

    Where a robot stood there stands now a person, who stretches the tape to the first wall on the
    map, nine times side by side. The deviation is theirs: an error of a pose moves all nine alike.

    Parameters
    ----------
    map
        SegmentMap, Reduction or `(n, 2, 2)` array, metres.
    poses : (250, 3) array, metres and radians, or None
        Of the scans of the log `clinic`, or of a variant, in the frame of the map; None: true ones.

    Examples
    --------
    >>> measure_clinic(clinic_walls())
    wardrobe goes round: 16.7 ± 0.1 cm to spare; wall 10.0 ± 0.1 cm; building 9.00 ± 0.00 m
    """
    walls, truth = arrays.segments(map, "map"), _true_poses()
    at = truth if poses is None else arrays.poses(poses, "poses")
    if len(at) != len(truth):
        raise ValueError(f"poses must have one row a scan of 'clinic', {len(truth)}, got {len(at)}")
    tapes, ends = {}, {}
    for name, (stand, other) in TAPES.items():
        (first, back), (second, ahead) = (_stretched(walls, at, place) for place in (stand, other))
        along = np.array([np.cos(second[0, 2]), np.sin(second[0, 2])])
        between_stands = (second - first[::-1])[:, :2] @ along
        lengths = between_stands + ahead + back[::-1]
        tapes[name] = _middle(-lengths if name == "wall" else lengths)  # seen from both its sides
        ends[name] = np.array([_end(first, back), _end(second, ahead)])
    left_tape, upper_tape = tapes["left corridor"], tapes["upper corridor"]
    room, turn = clearance(left_tape.metres, upper_tape.metres)
    deviation = np.hypot(np.cos(turn) * left_tape.deviation, np.sin(turn) * upper_tape.deviation)
    answer = Measured(float(room), float(deviation))
    return Answers(answer, tapes["wall"], tapes["building"], float(turn), tapes, ends)


@cache
def _true_poses() -> Array:
    truth = load("clinic").truth
    assert truth is not None
    return truth


def _stretched(walls: Array, poses: Array, place: ArrayLike) -> tuple[Array, Array]:
    """Nine poses `(9, 3)` side by side at a true place on a map, and how far the first wall is."""
    truth, there = _true_poses(), np.asarray(place, float)
    k = np.hypot(*(truth[:, :2] - there[:2]).T).argmin()
    here = compose(poses[k], between(truth[k], there))
    starts = np.array([compose(here, (0.0, aside, 0.0)) for aside in ASIDE_M])
    return starts, np.concatenate([cast_rays(walls, start, [0.0]) for start in starts])


def _end(starts: Array, lengths: Array) -> Array:
    """The end of the middle tape, `(2,)`; NaN where it met no wall."""
    (x, y, turn), length = starts[len(starts) // 2], lengths[len(lengths) // 2]
    ahead = np.array([np.cos(turn), np.sin(turn)])
    return (x, y) + (length if np.isfinite(length) else np.nan) * ahead


def _middle(lengths: Array) -> Measured:
    """The median of nine lengths and half the span without the least and the largest, metres.

    At least what a tape can be read to.
    """
    low, middle, high = np.sort(lengths)[[1, len(lengths) // 2, -2]]
    if not np.isfinite([low, high]).all():
        return Measured(np.nan, np.nan)
    return Measured(float(middle), max(float(high - low) / 2, READING_M))
