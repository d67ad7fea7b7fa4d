"""The pose graph on real logs: Malaga, and Intel from raw odometry where it is present."""

import numpy as np
from conftest import shared_file

from segmap import read
from segmap.alignment import pose_graph
from segmap.metrics import relation_errors
from segmap.poses import between


def test_intel():
    """The bounds of the benchmark; measured 0.030, 0.14 and 0.2 to 0.3, odometry 3.5 and 62 m.

    2672 scans from raw odometry, about 15 s. Most places are passed more than once: hundreds of
    loops, hardly a scan left out.
    """
    log = read(shared_file("data/intel.log.gz"))
    found = pose_graph(log)
    relations = np.loadtxt(shared_file("data/intel.relations.gz"))
    far, turned = relation_errors(log.times, found.poses, relations)
    assert len(far) == 566
    assert far.mean() <= 0.045
    assert np.quantile(far, 0.95) <= 0.15
    assert far.max() <= 0.6
    assert turned.mean() < np.radians(1.5)
    assert found.used.mean() > 0.99
    assert found.graph.loop.sum() > 100
    assert found.graph.rejected
    np.testing.assert_allclose(between(found.poses[0], log.odometry[0]), 0, atol=1e-9)
