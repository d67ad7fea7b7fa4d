"""The pose graph on real logs: Malaga, and Intel from raw odometry where it is present."""

import numpy as np
import pytest
from conftest import shared_file

from segmap import load, read
from segmap.alignment import Alignment, pose_graph
from segmap.metrics import relation_errors
from segmap.poses import between
from segmap.scans import Log


def rigid_error(found: np.ndarray, wanted: np.ndarray) -> float:
    """Root mean square distance after the best turn and shift, metres."""
    a, b = (p[:, :2] - p[:, :2].mean(0) for p in (found, wanted))
    cross = a.T @ b
    turn = np.arctan2(cross[0, 1] - cross[1, 0], np.trace(cross))
    c, s = np.cos(turn), np.sin(turn)
    return float(np.sqrt(((a @ np.array([(c, s), (-s, c)]) - b) ** 2).sum(1).mean()))


def test_malaga():
    """0.087 m measured against the 99 poses, which are bent by up to 2 degrees themselves."""
    log = load("malaga")
    known = np.isfinite(log.truth).all(1)
    assert rigid_error(log.odometry[known], log.truth[known]) > 2
    found = pose_graph(log)
    assert rigid_error(found.poses[known], log.truth[known]) < 0.09
    assert found.used.all()


@pytest.fixture(scope="module")
def intel() -> tuple[Log, Alignment]:
    """2672 scans from raw odometry: about 15 s."""
    log = read(shared_file("data/intel.log.gz"))
    return log, pose_graph(log)


def test_intel(intel):
    """The bounds of the benchmark; measured 0.030, 0.14 and 0.2 to 0.3, odometry 3.5 and 62 m."""
    log, found = intel
    relations = np.loadtxt(shared_file("data/intel.relations.gz"))
    far, turned = relation_errors(log.times, found.poses, relations)
    assert len(far) == 566
    assert far.mean() <= 0.045
    assert np.quantile(far, 0.95) <= 0.15
    assert far.max() <= 0.6
    assert turned.mean() < np.radians(1.5)


def test_the_graph_of_intel(intel):
    """Most places are passed more than once: hundreds of loops, hardly a scan left out."""
    log, found = intel
    assert np.isfinite(found.poses).all()
    assert found.used.mean() > 0.99
    assert found.graph.loop.sum() > 100
    assert found.graph.rejected
    np.testing.assert_allclose(between(found.poses[0], log.odometry[0]), 0, atol=1e-9)
