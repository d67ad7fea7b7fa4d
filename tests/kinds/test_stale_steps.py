"""What is kept of the run before, where choices change: the outcome is as if nothing had been."""

import numpy as np
import pytest
from driven_panels import parts_of, view_of

from segmap import load
from segmap_app.page import Workbench

LOG = load("room")[:8]


def counted_clockwise(page):
    words = "the beams are counted clockwise"
    return next(p for p in parts_of(view_of(page)) if getattr(p, "description", "") == words)


#: A control of the page, and what it is set to.
CHANGED = {
    "prepare": (counted_clockwise, True),
    "align": (lambda page: page.align, "segment_icp"),
    "extract": (lambda page: page.extract, "extract_clusters"),
    "passers": (lambda page: page.people, 0.9),
    "method": (lambda page: page.method, "mean_shift"),
    "points": (lambda page: page.method, "viewing_sector"),
    "turned": (lambda page: page.edits.square, True),
    "crop": (lambda page: page.edits.crop, "0 0 3 9"),
    "filter": (lambda page: page.least, 0.5),
}


def begun():
    page = Workbench(LOG)
    page.align.value, page.method.value = "odometry", "fusion"
    return page


def after(page, control, value):
    """All that is made once a control is set, step by step."""
    control(page).value = value
    page.wait()  # an edit of a map runs at once
    page.run()
    made = page.outcome
    found = {"log": np.concatenate([scan.points() for scan in made.log])}
    found |= {"poses": made.alignment.poses, "map": made.map.segments}
    found |= {f"reduced {k}": one.segments for k, one in enumerate(made.reductions)}
    return found | {"quality": np.array(made.qualities)}


@pytest.mark.parametrize("change", CHANGED)
def test_each_choice_changes_what_hangs_on_it_and_comes_back(change):
    """Catches a step of the run before that is kept though what it hangs on has changed."""
    control, value = CHANGED[change]
    page = begun()
    first = control(page).value
    made = [after(page, control, set_to) for set_to in (first, value, first)]
    fresh = after(begun(), control, value)
    for found, wanted in ((made[1], fresh), (made[2], made[0])):
        assert list(found) == list(wanted)
        for step, one in found.items():
            np.testing.assert_array_equal(one, wanted[step], step)
