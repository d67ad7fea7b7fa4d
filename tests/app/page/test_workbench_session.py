"""Sessions of the workbench: what is chosen comes back, and the command makes the same map."""

import base64
import io
import json
import re

import numpy as np
import pytest
from driven_panels import parts_of, view_of
from matplotlib.image import imread
from programs import program

import segmap
from segmap import readers
from segmap_app import files
from segmap_app.page import Workbench

main = program("segmap")


@pytest.fixture
def chosen():
    """A workbench on which much is not as at first."""
    workbench = Workbench(segmap.load("room"))
    workbench.align.value, workbench.extract.value = "odometry", "extract_clusters"
    workbench.extract["gap"].value, workbench.extract["fit"].value = 0.251234567, "algebraic"
    workbench.method.value, workbench.least.value = "hybrid", 0.15
    workbench.method["angle"].value = 7.5
    workbench.second.value, workbench.deskew.value = "mean_shift", False
    named = {getattr(part, "description", ""): part for part in parts_of(view_of(workbench))}
    for words, value in KEPT.items():
        named[words].value = value
    workbench.second["sigma"].value, workbench.people.value = 0.3, 0.35
    return workbench


#: What is chosen of the laser and its log, by the words of the page.
KEPT = {
    **{"keep beams that see the robot itself": True, "the beams are counted clockwise": True},
    **{"laser [m, degrees]": "0.25 0 180", "mask [degrees]": "-170:-150,150:170"},
}
SETTINGS = {
    **{"align": "odometry", "extract": "extract_clusters", "extract_gap": 0.251234567},
    **{"extract_fit": "algebraic", "method": "hybrid", "angle": 7.5, "filter": 0.15},
    **{"second": "mean_shift", "second_sigma": 0.3, "no_deskew": True, "seen_through": 0.35},
    **{"keep_body": True, "clockwise": True, "mount": [0.25, 0.0, 180.0]},
    "mask": ["-170:-150,150:170"],
}


def test_what_is_chosen_comes_back(chosen, tmp_path):
    """Catches a choice that is lost, degrees that become radians, and a slider left as it was."""
    one, again = tmp_path / "one.segmap", tmp_path / "again.segmap"
    chosen.export(one)
    assert files.read_session(one).settings == SETTINGS
    other = Workbench(segmap.load("room"))
    other.method.value = "hybrid"
    other.method["distance"].value = 0.9
    other.open(one)
    other.export(again)
    assert files.read_session(again).settings == SETTINGS
    files.write_session(one, files.Session(chosen.log, {"method": "fusion", "tolerance": 3.0}))
    other.open(one)
    assert other.method["tolerance"].value == 3.0 and other.extract.value == "extract_polylines"
    assert (other.align.value, other.second.value) == ("pose_graph", "none")
    for wrong in ({"method": "magic"}, {"method": "fusion", "tolerance": "wide"}):
        files.write_session(one, files.Session(chosen.log, wrong))
        with pytest.raises(ValueError, match="the session cannot be chosen here: "):
            other.open(one)


def test_page_and_command_make_one_map(chosen, tmp_path, monkeypatch, capsys):
    """Catches a default, a unit or a threshold in which the two differ."""
    monkeypatch.chdir(tmp_path)
    chosen.run()
    chosen.export("it.SEGMAP")
    assert main(["map", "it.SEGMAP", "--json", "-o", "it.csv"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["session"]["text"] == "its second, second_sigma left out: no option here"
    wanted = chosen.outcome.reductions[0].segments
    assert np.array_equal(readers.read_segments("it.csv").segments, wanted) and len(wanted) > 20
    exec(chosen.code, names := {"log": chosen.log})
    assert np.array_equal(names["reduced"].segments, wanted)
    assert np.array_equal(names["other"].segments, chosen.outcome.reductions[1].segments)
    # opened in another page, it is chosen as it was; its runs stand in the table
    page = Workbench(segmap.load("malaga")[:3])
    page.open("it.SEGMAP")
    assert page.log.name == "room" and page.runs.equals(chosen.runs) and len(page.runs) == 2
    page.run()
    assert np.array_equal(page.outcome.reductions[0].segments, wanted)


@pytest.fixture(scope="module")
def mended():
    """The corridor with a loop left out, one forced, and all other edits; its graph takes seconds.

    What a test takes back the next one does not ask for.
    """
    page = Workbench()
    page.open("corridor")
    page.align.value, page.method.value = "pose_graph", "fusion"
    page.run()
    page.loops.open.value = True
    page.loops.listed.value = page.loops.listed.options[0][1]  # the worst
    page.loops.mend.click()
    page.wait()
    page.loops.first.value, page.loops.second.value = 152, 5
    page.loops.tie.click()
    page.wait()
    page.edits.square.value = True
    page.wait()
    page.edits.crop.value, page.edits.place.value = "-30, -5 5.5 30", "36.7 -4.4"
    page.wait()
    page.edits.north.value = "60"
    page.wait()
    return page


EDITS = {
    **{"veto": ["4-151"], "tie": ["5-151"], "square": True, "crop": [-30.0, -5.0, 5.5, 30.0]},
    **{"place": [36.7, -4.4], "north": [60.0]},
}


def test_a_mended_map_is_that_of_its_code_and_of_the_command(mended, tmp_path, monkeypatch, capsys):
    """Catches an edit that one of the three leaves out, or makes in another order."""
    monkeypatch.chdir(tmp_path)
    plain = segmap.build_map(mended.log, segmap.alignment.pose_graph(mended.log).trusted)
    assert len(mended.outcome.map) < len(plain)
    assert mended.outcome.alignment.loops()["first"].tolist() == [0, 1, 3, 5]
    wanted = mended.outcome.reductions[0].segments
    exec(mended.code.replace("# segmap.exports", "segmap.exports"), names := {})
    assert np.array_equal(names["reduced"].segments, wanted)
    mended.export("page.geojson")
    mended.export("it.segmap")
    assert main(["map", "it.segmap", "-o", "it.csv", "-o", "it.geojson", "-o", "more.segmap"]) == 0
    assert np.array_equal(readers.read_segments("it.csv").segments, wanted)
    written = [(tmp_path / f"{name}.geojson").read_bytes() for name in ("map", "page", "it")]
    assert len({*written}) == 1 and b'"crs"' not in written[0]
    assert main(["map", "it.segmap", "-o", "it.dxf"]) == 0  # without a use for the place
    # and comes back, from the command's session too
    assert files.read_session("it.segmap").edits == EDITS
    for name in ("it.segmap", "more.segmap"):
        page = Workbench(segmap.load("malaga")[:3])
        page.open(name)
        assert page.edits.value() == EDITS
    page.run()
    assert np.array_equal(page.outcome.reductions[0].segments, wanted)
    page.open(segmap.load("room"))
    assert page.edits.value() == {}  # of another map


def test_a_loop_is_taken_back_without_a_scan_placed_anew(mended):
    """Catches an edit that is for ever, a list that forgets it, and work that is done twice."""
    loops, said = mended.loops, []
    mended.state.observe(lambda change: said.append(change["new"]), names="value")
    words, names = zip(*loops.listed.options, strict=True)
    assert {*names} == {"0-145", "1-147", "3-149", "4-151", "5-151"}
    assert words[0] == "4-151: left out"
    forced = words[names.index("5-151")]
    assert re.fullmatch(r"5-151 \(by you\): 0\.\d\d sd off, 7\d m round", forced)
    assert loops.open.description == "loops (4)" and loops.mend.description == "Take it back"
    for name in ("1-147", "1-147", "5-151", "4-151"):  # the first is left out, and taken back
        loops.listed.value = name
        loops.mend.click()
        mended.wait()
        assert name == "5-151" or loops.listed.value == name  # it stays chosen
    assert mended.edits.value().keys() == EDITS.keys() - {"veto", "tie"}
    assert any("mending the graph" in words for words in said)
    assert not any("placing" in words for words in said)
    found = segmap.alignment.pose_graph(mended.log)
    assert np.array_equal(mended.outcome.alignment_in_log_frame.poses, found.poses)
    assert np.array_equal(mended.outcome.alignment.loops()["second"], found.loops()["second"])


def test_two_scans_are_seen_over_each_other_and_on_the_way(mended):
    """Catches a picture of other scans, one drawn thrice or with wide margins, a click that is
    lost, and a way that is shown for ever."""
    loops, canvas = mended.loops, mended.canvas
    png = base64.b64decode(re.search('base64,([^"]+)"', loops.picture.value).group(1))
    dark = imread(io.BytesIO(png))[..., :3].min(2) < 0.5
    full = [np.ptp(np.flatnonzero(dark.any(k))) / dark.shape[1 - k] for k in (0, 1)]
    assert dark.shape[0] != dark.shape[1] and min(full) > 0.8
    loops.listed.value = "1-147"
    assert 'alt="scan 1 black, scan 147 orange' in loops.picture.value
    for scan in (20, 30):
        canvas._handle_custom_msg({"scan": scan}, [])
    assert (loops.first.value, loops.second.value, canvas.looked_at) == (20, 30, [20, 30])
    poses = mended.outcome.alignment.poses
    apart = np.hypot(*(poses[20] - poses[30])[:2])
    assert f'alt="scan 20 black, scan 30 orange, {apart:.1f} m apart' in loops.picture.value
    middle = mended.outcome.map.segments.reshape(-1, 2)
    middle = (middle.min(0) + middle.max(0)) / 2
    way = np.frombuffer(canvas.way, np.float32).reshape(-1, 2)
    assert np.allclose(way + middle, poses[:, :2], atol=1e-5)
    assert loops.first.max == len(mended.log) - 1
    loops.open.value = False
    assert canvas.looked_at == []
    mended.edits.drag.value = True
    assert canvas.drawing
    canvas._handle_custom_msg({"rectangle": [-1, -2, 3, 4]}, [])
    mended.wait()
    assert not canvas.drawing and loops.listed.value == "1-147", "it stays chosen"
    assert np.allclose(
        mended.edits.value()["crop"], [*(middle - (1, 2)), *(middle + (3, 4))], atol=0.01
    )


def test_a_new_map_is_seen_before_it_is_reduced():
    """Catches a page that waits with all it has, and a map that stays where its reduction fails."""
    page, seen = Workbench(segmap.load("room")), []
    page.align.value, page.method.value = "odometry", "fusion"
    page.run()

    page.canvas.observe(lambda change: seen.append(change["new"]), names="titles")
    for least, method in ((0.5, "fusion"), (1.0, "mean_shift")):
        page.least.value, page.method.value = least, method
        if method == "mean_shift":
            page.method["bandwidth"].value = 1e-9  # which it refuses
        page.start.click()
        page.wait()
        made = page.outcome
        assert made.recipe.least == 0.5 and len(page.canvas.before) == 16 * len(made.map)
    now = [f"before: {len(made.map)} segments", f"fusion: {len(made.reductions[0])}"]
    assert seen[:2] == [[now[0], "not reduced yet"], now]
    assert seen[2][1] == "not reduced yet" and seen[2][0] != now[0]
    assert page.canvas.titles == now and "bandwidth must" in page.state.value
