"""A reader makes no time, delay or reach up; what else it must assume, it lists."""

import numpy as np
import pytest
from log_samples import ASSUMED, CENTRE, NPZ, RAWSEEDS, SINGLE_FILES, TIMELESS, TURNING

import segmap
from segmap import readers
from segmap.readers import LogError


@pytest.mark.parametrize("name", SINGLE_FILES)
def test_no_time_and_no_delay_is_made_up_and_the_rest_is_listed(name, tmp_path):
    """Catches scans that are numbered for want of times, and an assumption that nobody sees."""
    (tmp_path / name).write_text(SINGLE_FILES[name])
    log = readers.read(tmp_path / name)
    known = np.isfinite(log.times)
    assert not known.any() if name in TIMELESS else known.all(), "log_samples.TIMELESS lists these"
    timed = [scan.delays is not None for scan in log]
    assert timed == [name in TURNING] * len(log), "log_samples.TURNING lists these"
    begins = {next((b for b in ASSUMED[name] if said.startswith(b)), said) for said in log.assumed}
    assert begins == ASSUMED[name] and len(log.assumed) == len(begins)


def test_arrays_and_folders_list_what_they_leave_open(tmp_path):
    """Catches a place of the laser that a folder of Rawseeds, or arrays, are thought to hold."""
    (tmp_path / "it.npz").write_bytes(NPZ)
    assert readers.read(tmp_path / "it.npz").assumed == (CENTRE,)
    (tmp_path / "raw").mkdir()
    for name, content in RAWSEEDS.items():
        (tmp_path / "raw" / name).write_text(content)
    assert CENTRE in readers.read(tmp_path / "raw").assumed
    (tmp_path / "scans").mkdir()
    for number in (2, 10):
        (tmp_path / "scans" / f"{number}.txt").write_text("urg_mm angle_rad\n1000 0.0\n")
    log = readers.read(tmp_path / "scans")
    assert np.isnan(log.times).all() and "the order of the numbers" in log.assumed[-1]


def test_a_log_that_is_written_and_read_again_assumes_the_same(tmp_path):
    """Catches an assumption that is a fact after a detour by segmap's own file, and new times."""
    (tmp_path / "1.txt").write_text("urg_mm angle_rad\n1000 0.0\n1000 0.1\n")
    log = readers.read(tmp_path / "1.txt")
    segmap.exports.write_arrays(tmp_path / "it.npz", log)
    again = readers.read(tmp_path / "it.npz")
    assert set(again.assumed) == set(log.assumed) and np.isnan(again.times).all()
    segmap.exports.write_carmen(tmp_path / "it.log", log)
    assert "times are the numbers of the scans" in (tmp_path / "it.log").read_text()


class TestWords:
    """What a number really is has a word that is right."""

    @pytest.mark.parametrize(
        ("ranges", "most", "word"),
        [
            ([2345.0, 2346.0, 2347.0, 3000.0], 30.0, "millimetres"),
            ([234.0, 235.0, 236.0, 300.0], 30.0, "millimetres, ranges / 1000, or centimetres"),
            ([2.0, 65533.0, 65533.0, 65533.0], np.inf, "65533 m mean that nothing was met"),
        ],
    )
    def test_of_ranges(self, ranges, most, word):
        """Catches ranges that are beyond the reach because of their unit, and go without a word."""
        with pytest.warns(UserWarning, match=word):
            segmap.LaserScan(ranges, np.arange(len(ranges)) / 100, max_range=most)

    def test_of_angles_that_count_down(self, tmp_path):
        """Catches "expected radians" for a step that is negative."""
        line = "ROBOTLASER1 0 1.57 3.14 -0.785 50 0.01 0 5 1 2 3 4 5 0" + " 0" * 11 + " 1.0 host 0"
        (tmp_path / "it.log").write_text(line + "\n")
        with pytest.raises(LogError, match=r"angles that count up, got a step of -0\.785"):
            readers.read(tmp_path / "it.log")
