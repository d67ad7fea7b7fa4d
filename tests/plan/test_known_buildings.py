"""Floor plans of simulated buildings: what is wrong must be told."""

import numpy as np
import pytest
from plan_buildings import KINDS, SENSORS, log_of, seen, wrong_in

from segmap.plan import floor_plan

GOES_ON, WIDE = "may go on", "wider than a leaf"
#: Kind, sensor, seed; words of what is wrong; words of the doubt, nothing for none.
SITUATIONS = [
    ("two rooms", "URG", 1, "", ""),
    ("two rooms", "360", 0, "", ""),
    ("leaf at 20 to 40", "360", 3, "", ""),
    ("leaf at 40 to 70", "SICK", 0, "", ""),
    ("leaf at 40 to 70", "360", 0, "", ""),
    ("leaf at 70 to 90", "URG", 0, "", ""),
    ("any leaf", "360", 4, "", ""),
    ("wall as thick as the band", "360", 0, "", ""),
    ("wall as thick as the band", "360", 1, "", ""),
    ("furnished, leaves at 60", "360", 2, "", None),
    ("round", "360", 0, "", ""),
    ("L corridor", "360", 3, "", ""),
    ("L corridor", "SICK", 0, "", ""),
    ("T corridor", "360", 0, "", ""),
    ("pillars", "360", 0, "", ""),
    ("pillars", "URG", 0, "", ""),
    ("opening of 2 m", "SICK", 1, "", ""),
    ("glass outside", "360", 0, "", ""),
    ("glass outside", "URG", 1, "", ""),
    ("glass between", "360", 0, "false door", WIDE),
    ("thin walls", "360", 0, "", ""),
    ("thin walls", "URG", 1, "", ""),
    ("furniture along a wall", "360", 0, "", ""),
    ("furniture along a wall", "URG", 1, "", ""),
    ("corridor of 60 m", "360", 7, "", ""),
    ("mouths wider than the corridor", "360", 0, "", ""),
    ("mouths wider than the corridor", "360", 1, "", ""),
    ("corridor into a room", "360", 0, "", ""),
    ("corridor into a room", "SICK", 1, "", ""),
    ("turned by 17 degrees", "360", 5, "", ""),
    ("wings at 45 degrees", "SICK", 0, "", None),
    ("half seen", "URG", 0, "room 0 of 123.0 m2 not found", GOES_ON),
    ("half seen", "SICK", 1, "room 0 has", GOES_ON),
    ("seen through a door", "SICK", 0, "not found", "openings to where nothing was seen"),
]


@pytest.mark.parametrize(("kind", "sensor", "seed", "wrong", "doubt"), SITUATIONS)
def test_what_is_wrong_is_told(kind, sensor, seed, wrong, doubt):
    """Catches a leaf that hides its jamb, a gap between rays that shuts a door, a border unseen,
    a border that is told along a wall or around less than a room, a corridor that is cut where
    rooms open into it, or that is a part of the room at its end."""
    building = KINDS[kind](np.random.default_rng(seed))
    log = log_of(building, SENSORS[sensor], seed)
    plan = floor_plan(*seen(log, log.truth))
    found = "; ".join(wrong_in(plan, building))
    assert (wrong in found) if wrong else not found
    if doubt is not None:  # None: what furniture hides depends on the way
        assert (doubt in plan.doubt) if doubt else not plan.doubt


def test_the_table_has_all_kinds():
    """Catches a kind that is only measured by hand."""
    assert {row[0] for row in SITUATIONS} == set(KINDS)
