"""What chapters 18 to 20 say of more than their own case: other lasers, other buildings."""

import pytest
from past_a_wall import NOISE, drive_past_a_wall, thickness

import segmap
from segmap.reduction import segment_similarity, uncertain_parameters


@pytest.mark.parametrize("building", ["clinic", 0, 1])
@pytest.mark.parametrize("noise", NOISE, ids=str)
def test_a_wall_of_10_cm_stays_at_2_cm_of_cost_or_5_cm_of_distance(noise, building):
    """Chapter 18: over true poses; catches weights that pull one face to the other."""
    for seed in range(2):  # five were tried
        log, middle = drive_past_a_wall(building, noise, seed)
        map = segmap.build_map(log, log.truth, keep_points=True)
        for kept in (
            segment_similarity(map, distance=0.02),
            uncertain_parameters(map, distance=0.05),
        ):
            assert 0.08 < thickness(kept.segments, middle) < 0.13
        assert thickness(uncertain_parameters(map, distance=0.12).segments, middle) < 0.01
