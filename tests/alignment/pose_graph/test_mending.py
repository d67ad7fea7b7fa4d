"""Clusters of loops that tear the chain: dropped where the wheels agree with it, else told."""

from dataclasses import replace

import alignment_logs as logs
import numpy as np

from segmap.alignment import pose_graph, position_errors
from segmap.scans import LaserScan, Log
from segmap.scans.causes import Cause
from segmap.simulation import OdometryNoise, box, cast_rays, drive, polyline, simulate


def traffic_jam() -> Log:
    """There and back along a bare wall, beside cars that all roll on by .7 m now and then."""
    wall, rng = polyline([(0, 0), (60, 0)]), np.random.default_rng(12)
    path = drive([(2, 1.2), (58, 1.2), (2, 1.25)], step=0.3, turn=np.radians(15))
    wheels = simulate(
        wall, path, sensor=logs.AROUND, rng=rng, odometry_noise=OdometryNoise()
    ).odometry
    scans = []
    for k, pose in enumerate(path):
        at = 0.7 * (k // 25)
        cars = [box(4.2, 1.8, ((6.0 * car + at) % 66 - 3, 4.0, 0.0)) for car in range(11)]
        ranges = cast_rays(np.concatenate([wall, *cars]), pose, logs.AROUND.angles, max_range=12.0)
        noise = np.where(np.isfinite(ranges), rng.normal(0, 0.01, len(ranges)), 0.0)
        scans.append(LaserScan(ranges + noise, logs.AROUND.angles, 0.2 * k, wheels[k], 12.0))
    return Log("jam", scans, path)


def test_loops_that_hold_each_other_fall_where_the_wheels_agree_with_the_chain():
    """Catches 74 false loops that agree, and a witness that is silenced without a third one."""
    log = traffic_jam()
    mended = pose_graph(log)
    assert position_errors(mended.poses, log.truth, best=True).max() < 0.25
    assert Cause.BEND not in {finding.cause for finding in mended.causes}
    alone = pose_graph(logs.without_odometry(log))
    far = position_errors(alone.poses, log.truth, best=True).max()
    assert alone.verdict.grade != "good" or far < 0.25
    false_wheels = log.odometry * (1.0, 1.0, 1.0) + np.sin(np.arange(len(log)) / 9)[:, None]
    scans = (replace(s, odometry=row) for s, row in zip(log, false_wheels, strict=True))
    told = pose_graph(replace(log, scans=tuple(scans)))
    assert told.verdict.grade != "good"
