"""What each control of the page says."""

import pytest
from driven_panels import parts_of, view_of

from segmap import alignment, load, reduction
from segmap_app.page import Workbench


@pytest.fixture(scope="module")
def workbench():
    return Workbench(load("room"))


@pytest.mark.parametrize("name", [*alignment.METHODS, *reduction.METHODS])
def test_each_control_and_each_method_says_what_it_is(workbench, name):
    """Catches a threshold without a sentence, and a label whose tooltip is "null"."""
    choice = workbench.align if name in alignment.METHODS else workbench.method
    choice.value = name
    assert name.replace("_", " ") in choice.advice.value and len(choice.advice.value) > 120
    for keyword, each in choice.controls.items():
        assert each.tooltip.startswith(f"{keyword}: ") and len(each.tooltip) > len(keyword) + 10


def test_no_label_of_the_workbench_says_null(workbench):
    """Catches a control with a name and no tooltip, of which a browser makes "null"."""
    named = [part for part in parts_of(view_of(workbench)) if part.has_trait("tooltip")]
    named = [part for part in named if getattr(part, "description", "")]
    assert len(named) > 30 and all(part.tooltip for part in named)
