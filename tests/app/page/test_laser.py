"""The laser of the page's step *Live*: its tick, and the end that a drive does not have."""

import numpy as np

from segmap.readers import read
from segmap.scans import LaserScan
from segmap_app.drives import record, save_each
from segmap_app.page import _job
from segmap_app.page._source import Laser


def test_the_tick_turns_what_is_shown_and_the_log_whenever_it_is_set(tmp_path):
    """Catches a tick that counts from the next Start on: map and log stay mirrored until then."""
    angles = np.linspace(-3, 3, 90)
    scans = [LaserScan(1 + np.arange(90) / 50, angles, k, delays=angles + 3) for k in (0.0, 10.0)]
    path = tmp_path / "drive.csv"
    list(save_each(scans, path))
    laser, seen = Laser(), []
    laser.port.value = "/dev/ttyUSB0"
    assert laser.named()[3] is None
    show, places = laser.turning(lambda *those: seen.append(those)), np.array([[1.0, 2.0]])
    show(places, "words")
    laser.mirrored.value = True
    show(places, "words")
    assert [those[0].tolist() for those in seen] == [[[1.0, 2.0]], [[1.0, -2.0]]]
    before = read(path)
    for log in (laser.turned(before, path), read(path)):
        for new, old in zip(log, before, strict=True):
            assert np.allclose(new.points(), old.points() * (1, -1), atol=1e-5)
            assert np.array_equal(new.delays, old.delays) and new.time == old.time
    assert laser.named()[3] is False and laser.turned(before, path) is before  # from Start on


def test_a_drive_has_no_end_that_kills_it():
    """Catches an hour after which a drive is ended and its map is lost."""
    assert _job.PATIENCE_S[record] > 0 and _job.most_time_s(record) == 0
    assert _job.most_time_s(save_each) == _job.MOST_TIME_S
