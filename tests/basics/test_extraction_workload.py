"""Precision and recall of polylines on the fixed workload that lies beside the project."""

import numpy as np
import pytest

from segmap.extraction import extract_polylines


@pytest.mark.parametrize("case", ["office_181", "office_1081"])
@pytest.mark.parametrize(
    ("thresholds", "truth"),
    [({"min_points": 8, "min_length": 0.3}, {}), ({}, {"min_beams": 2, "min_length": 0.0})],
    ids=["same thresholds for both", "defaults against all visible walls"],
)
def test_precision_and_recall(workloads, case, thresholds, truth):
    """Within 5 cm and 5 degrees, by length. The truth leaves out pieces of fewer than 8 beams or
    0.3 m unless told otherwise; so recall is asked where both have the same thresholds."""
    office = workloads.extraction_case(case, **truth)
    scores = np.zeros(4)
    for ranges, pieces in zip(office.ranges, office.truth, strict=True):
        points = workloads.end_points(ranges, office.sensor.angles)
        scores += workloads.score_segments(extract_polylines(points, **thresholds), pieces)
    assert scores[0] / scores[1] >= 0.99
    if not truth:
        assert scores[2] / scores[3] >= 0.99
