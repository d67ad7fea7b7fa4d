"""Real logs: Malaga, which comes with segmap, and those that may only lie beside the project."""

import numpy as np
import pytest
from conftest import shared_file
from scipy.spatial import cKDTree

from segmap import poses, readers


def spread_of_walls(log, at):
    """Median distance from a point to the nearest one of the scans drawn before, metres."""
    clouds = [poses.transform(pose, scan.points()) for pose, scan in zip(at, log, strict=True)]
    half = len(clouds) // 2
    tree = cKDTree(np.concatenate(clouds[:half]))
    return np.median(tree.query(np.concatenate(clouds[half:]))[0])


class TestMalaga:
    def test_corrected_poses_bring_the_walls_together(self):
        """Poses of the laser taken for the robot's, or of another scan, blur the map."""
        log = readers.load("malaga")
        known = np.flatnonzero(np.isfinite(log.truth).all(axis=1))
        scans, truth = [log[int(k)] for k in known], log.truth[known]
        corrected = spread_of_walls(scans, truth)
        assert corrected < 0.08
        assert spread_of_walls(scans, log.odometry[known]) > 3 * corrected
        assert spread_of_walls(scans, poses.compose(truth, (0.78, 0, 0))) > 1.2 * corrected


#: Of each file: scans, beams, largest range, scans with truth, metres driven where known (NaN: no
#: odometry).
SHARED = {
    "intel.log.gz": (2672, 180, 50, 2672, None),
    "fr079.log.gz": (4791, 360, 50, 4791, np.nan),  # the corrected poses are no odometry
    "laserazos.log.gz": (778, 361, np.inf, 0, None),
    "urg04lx-exp1.dat.gz": (756, 683, 5.6, 0, None),
    "formats/gmapping-acapulco.log.gz": (861, 181, 50, 861, np.nan),
    "formats/gmapping-sample.gfs": (12, 361, 50, 12, 7.10),
    "formats/dpslam-first-40-lines.log": (20, 181, 8.18, 0, 0.004),
    "formats/wean-robotdata4.log.gz": (600, 180, 50, 0, 21.50),
    "formats/coreslam-test_lab2.dat.gz": (404, 683, 5.6, 0, 24.62),
}


@pytest.mark.parametrize("name", SHARED)
def test_shared_logs(name):
    """A format that was understood wrongly agrees with its own writer only."""
    scans, beams, limit, known, driven = SHARED[name]
    log = readers.read(shared_file(f"data/{name}"), on_error="skip")
    assert (len(log), {len(scan) for scan in log}) == (scans, {beams})
    assert log[0].max_range == limit and log.skipped.lines == ("lab2" in name)
    truth = np.full((1, 3), np.nan) if log.truth is None else log.truth
    assert np.isfinite(truth).all(1).sum() == known
    assert np.isnan(log.odometry).all() == (driven is np.nan)
    if driven is not None:
        assert length(log.odometry) == pytest.approx(driven, abs=0.01, nan_ok=True)
    if known:
        assert np.ptp(truth[:, :2], axis=0).max() > 2


class TestShared:
    def test_coreslam(self):
        """Beams mirrored, or wheels swapped, would not bring any two scans together."""
        log = readers.read(shared_file("data/urg04lx-exp1.dat.gz"))
        assert np.ptp(log.times) == pytest.approx(74.62, abs=0.01)
        assert {0, 6, 7} <= set(np.unique([scan.codes for scan in log]).tolist())
        part = log[40:80:4]
        mirrored = part.odometry * [1, -1, -1]
        assert spread_of_walls(part, part.odometry) < 0.04 < spread_of_walls(part, mirrored)

    def test_killian(self):
        pytest.importorskip("rtbdata", reason="the package rtb-data is not installed")
        log = readers.load("killian")
        assert len(log) == 3873 and np.isfinite(log.truth).all() and log[0].max_range == 50


def length(path):
    return np.hypot(*np.diff(path[:, :2], axis=0).T).sum()
