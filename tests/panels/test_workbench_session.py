"""Sessions of the workbench: what is chosen comes back, and the command makes the same map."""

import json

import numpy as np
import pytest

import segmap
from segmap import readers
from segmap._commands import main
from segmap.panels import Workbench
from segmap.panels.workbench._session import restore, session_of


@pytest.fixture
def chosen():
    """A workbench on which much is not as at first."""
    workbench = Workbench(segmap.load("room"))
    workbench.align.value, workbench.extract.value = "odometry", "extract_clusters"
    workbench.extract["gap"].value, workbench.extract["fit"].value = 0.25, "algebraic"
    workbench.method.value, workbench.least.value = "hybrid", 0.15
    workbench.method["angle"].value = 7.5
    workbench.second.value, workbench.deskew.value = "mean_shift", False
    workbench.second["sigma"].value = 0.3
    return workbench


SETTINGS = {
    **{"align": "odometry", "extract": "extract_clusters", "extract_gap": 0.25},
    **{"extract_fit": "algebraic", "method": "hybrid", "angle": 7.5, "filter": 0.15},
    **{"second": "mean_shift", "second_sigma": 0.3, "no_deskew": True},
}


def test_what_is_chosen_comes_back(chosen, tmp_path):
    """Catches a choice that is lost, degrees that become radians, and a slider left as it was."""
    session = session_of(chosen._choices, chosen.log, [{"method": "hybrid"}])
    assert session.settings == SETTINGS and session.runs == [{"method": "hybrid"}]
    other = Workbench(segmap.load("room"))
    other.method.value = "hybrid"
    other.method["distance"].value = 0.9
    restore(other._choices, session)
    assert session_of(other._choices, chosen.log, ()).settings == SETTINGS
    restore(other._choices, readers.Session(chosen.log, {"method": "fusion", "tolerance": 3.0}))
    assert other.method["tolerance"].value == 3.0 and other.second.value == "none"
    for wrong in ({"method": "magic"}, {"method": "fusion", "tolerance": "wide"}):
        with pytest.raises(ValueError, match="the session cannot be chosen here: "):
            restore(other._choices, readers.Session(chosen.log, wrong))


def test_page_and_command_make_one_map(chosen, tmp_path, monkeypatch, capsys):
    """Catches a default, a unit or a threshold in which the two differ."""
    monkeypatch.chdir(tmp_path)
    chosen.run()
    chosen.export("it.segmap")
    assert main(["map", "it.segmap", "--json", "-o", "it.csv"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["session"]["text"] == "its second, second_sigma left out: no option here"
    wanted = chosen.outcome.reductions[0].segments
    assert np.array_equal(readers.read_segments("it.csv").segments, wanted) and len(wanted) > 20
    # opened in another page, it is chosen as it was; its runs stand in the table
    page = Workbench(segmap.load("malaga")[:3])
    page.open("it.segmap")
    assert page.log.name == "room" and page.runs.equals(chosen.runs) and len(page.runs) == 2
    page.run()
    assert np.array_equal(page.outcome.reductions[0].segments, wanted)
