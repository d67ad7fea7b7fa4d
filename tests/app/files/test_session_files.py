"""Sessions: all of a log and of what was made of it comes back, and old files stay readable."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import segmap
from segmap.files import write_npz
from segmap.readers import LogError, read
from segmap.scans import Skipped
from segmap.scans.causes import Cause, Finding
from segmap_app.files import Session, read_session, write_session

OLD = Path(__file__).with_name("version_1.segmap")


def shot(count, time, **more):
    return segmap.LaserScan(np.arange(1.0, count + 1), np.linspace(-1, 1, count), time, **more)


LOG = segmap.Log(
    "it",
    [
        shot(3, 1.0, delays=[0, 0.1, 0.2], codes=[0, 7, 0], odometry=(1, 2, 0.5)),
        shot(5, 2.0, codes=np.arange(5), max_range=4.5, sensor_pose=(0.1, 0, 3)),
    ],
    [(np.nan,) * 3, (1, 2, 0.5)],
    Skipped(2, "it.log, line 3: no range"),
    order_known=False,
    causes=[Finding(Cause.MIRRORED, -1.0, "the odometry runs backwards", "--clockwise", True)],
)
SESSION = Session(
    LOG, {"method": "fusion", "tolerance": 0.05}, [{"quality": np.nan}], {"crop": (0, -1, 4.5, 3)}
)


def told(session):
    """All of a session but its log, with NaN and tuples as JSON has them."""
    return session.settings, session.runs, session.edits


def same(log, other):
    """Whether two logs are equal in all that they hold."""
    for a, b in zip(log, other, strict=True):
        for name in ("ranges", "angles", "odometry", "sensor_pose", "codes", "delays"):
            np.testing.assert_array_equal(getattr(a, name), getattr(b, name), name)
        assert (a.time, a.max_range, len(a)) == (b.time, b.max_range, len(b))
    np.testing.assert_array_equal(log.truth, other.truth)
    for name in ("skipped", "order_known", "causes"):
        assert getattr(log, name) == getattr(other, name)
    return True


def test_all_comes_back_for_scans_of_several_sizes(tmp_path):
    """Catches beams that are lost or made up, delays that turn to zero, a damage forgotten."""
    wanted = replace(LOG, scans=[LOG[0], replace(LOG[1], ranges=[1, 2, 3, 4, np.inf])])
    write_session(tmp_path / "mine.segmap", SESSION)
    found = read_session(tmp_path / "mine.segmap")
    assert found.log.name == "it" and same(found.log, wanted)  # 5 m is beyond its range
    figures = (
        {"method": "fusion", "tolerance": 0.05},
        [{"quality": None}],
        {"crop": [0, -1, 4.5, 3]},
    )
    assert told(found) == figures
    log = read(tmp_path / "mine.segmap")
    assert log.name == "mine" and same(replace(log, skipped=LOG.skipped, causes=LOG.causes), wanted)


def test_a_session_of_version_1_is_read_for_ever(tmp_path):
    """Catches a change of the file that makes yesterday's sessions unreadable."""
    found = read_session(OLD)
    write_session(tmp_path / "new.segmap", SESSION)
    new = read_session(tmp_path / "new.segmap")
    assert found.log.causes == (Finding(Cause.OTHER, 1, "the odometry runs backwards"),)
    found = replace(found, log=replace(found.log, causes=LOG.causes))
    assert told(found) == told(new) and same(found.log, new.log)


def refused(path, **said):
    """Write a session of which some parts are as `said`; what reading it tells."""
    parts = {
        "name": "it",
        "skipped": [0, ""],
        "causes": [],
        "settings": {},
        "runs": [],
        "edits": {},
    }
    held = {"ranges": np.ones((1, 2)), "angles": np.zeros((1, 2))}
    text = {"session.json": said.pop("text", json.dumps(parts | said))}
    write_npz(path, Session.FORMAT, held | text)
    with pytest.raises(LogError) as caught:
        read_session(path)
    return str(caught.value)


@pytest.mark.parametrize(
    ("said", "reason"),
    [
        ({"settings": [1]}, "settings must have a name for each value, got [1]"),
        ({"runs": [3]}, "runs must have a name for each value"),
        ({"text": "{}"}, "session.json is damaged ('name')"),
    ],
)
def test_a_session_that_is_none_is_refused(tmp_path, said, reason):
    """Catches a file from outside that ends in another error than `LogError`."""
    where = tmp_path / "it.segmap"
    text = refused(where, **said)
    assert text.startswith(f"{where}: ") and reason in text


def test_arrays_of_another_kind_are_no_session(tmp_path):
    segmap.exports.write_arrays(tmp_path / "it.npz", LOG[1:])
    with pytest.raises(LogError, match=r"it\.npz: not a session of segmap"):
        read_session(tmp_path / "it.npz")
