"""What can be wrong with a log or with its map: a cause, its figure, its words and its remedy."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Cause(StrEnum):
    """The kinds of things that go wrong; control flow asks for these, never for words."""

    # What the scans say
    BODY = "body"  # beams that see the robot itself
    NOTHING_MET = "nothing met"  # one number stands for "the beam met nothing"
    BEAM_ORDER = "beam order"  # in which order the beams were measured
    SKEW = "skew"  # the robot moved while it measured
    STANDS = "stands"  # scans between which the robot did not move
    # What the clocks say
    CLOCK = "clock"
    ORDER = "order"  # scans that are not in the order in which they were measured
    DELAY = "delay"  # odometry is late or early
    # What the odometry says
    JUMP = "odometry jump"
    NO_ODOMETRY = "no odometry"  # rows that do not say how the robot moved
    UNIT = "unit"
    SCALE = "scale"
    MIRRORED = "mirrored"  # the laser, or the wheels' turns
    ODOMETRY_MIRRORED = "odometry mirrored"
    MOUNTING = "mounting"  # the laser looks elsewhere than ahead
    LEVER_ARM = "lever arm"  # the laser's place on the robot
    LIFTED = "lifted or another floor"  # the robot was moved while nothing was measured
    # What the map says
    NO_DISTANCE = "free direction"
    UNTIED = "no match ties it"
    VAGUE = "vague"
    LEFT_FREE = "pose left free"
    NOT_ORTHOGONAL = "not orthogonal"
    NO_WALLS = "no walls"
    NOT_MERGED = "not merged"
    BEND = "bend"  # the poses do not keep what the matches said as they came
    NOT_CHECKED = "not checked"  # nothing confirms the poses
    OTHER = "other"  # words of an earlier version


#: Causes that always make a map doubtful.
DECISIVE = {Cause.SCALE, Cause.MIRRORED, Cause.LIFTED, Cause.BEND, Cause.NOT_MERGED}


class Unmatched(StrEnum):
    """Why a pose rests on no match; empty where it does. Code asks for these, never for words.

    The words that stand beside it may say more, with numbers.
    """

    NONE = ""
    # What the scan, and what it is matched with, show
    TOO_LITTLE_SEEN = "too few points"  # or walls
    NO_REFERENCE = "nothing to match it with"
    # What the match says
    NO_PLACE = "nothing like it near"
    LITTLE_OVERLAP = "too little of it lies on the map"
    SLIDES = "it slides over the map"
    OTHER_PLACE = "another place fits nearly as well"
    FREE_DIRECTION = "neither walls nor odometry say how far it went"
    # What the other scans say
    UNTIED = "no match ties it to the rest"
    TORN = "torn from its neighbours farther than segments correspond"
    # Why it was not matched at all
    TURNING = "taken while turning"
    TOO_NEAR = "too near to the last scan used"
    NO_ODOMETRY = "no odometry"
    NO_TRUTH = "no ground truth at its time"
    ASSUMPTION = "the assumption of the method fails"


@dataclass(frozen=True)
class Finding:
    """One thing that was found.

    Parameters
    ----------
    cause
        Its kind.
    value
        Its figure, in the unit that `words` name.
    words
        A sentence for a user.
    remedy
        What a user can do, as an option of `segmap map`; empty where there is nothing.
    doubtful
        Whether it makes a map doubtful. Corrected faults do not; faults that cannot be corrected
        (`DECISIVE`) always do.

    Examples
    --------
    >>> print(Finding(Cause.BODY, 38, "38 of 360 beams see the robot itself", "--keep-body"))
    38 of 360 beams see the robot itself: --keep-body
    """

    cause: Cause
    value: float
    words: str
    remedy: str = ""
    doubtful: bool = False

    def __post_init__(self) -> None:
        """A decisive cause makes a map doubtful, whoever finds it."""
        object.__setattr__(self, "doubtful", self.doubtful or self.cause in DECISIVE)

    def __str__(self) -> str:
        return f"{self.words}: {self.remedy}" if self.remedy else self.words
