"""A robot that drives to and fro in a room, and a graph whose loops close where a test plans it."""

import threading

import numpy as np

from segmap.alignment import LiveGraph
from segmap.alignment.pose_graph import Placed
from segmap.alignment.pose_graph._front_end import TrackedScan
from segmap.matching import LiveMap
from segmap.poses import compose
from segmap.simulation import Sensor, drive, rectangular_room, simulate

SENSOR = Sensor("it", 91, -np.pi, 2 * np.pi / 91, max_range=6.0, sigma=0.005)
LOG = simulate(
    rectangular_room(4, 3),
    drive([(1.2, 1.3), (2.8, 1.7), (1.2, 1.3)], step=0.1),
    sensor=SENSOR,
    rng=np.random.default_rng(4),
    sensor_pose=(0.2, 0.1, 0.3),
)[:24]


class Planned(LiveGraph):
    """A graph whose loops close at planned scans: each straightens a bent way some more."""

    def __init__(self, closes=(), log=LOG):
        super().__init__()
        self.log, self.closes, self.count, self.bend = log, closes, 0, 0.02

    def add(self, scan):
        assert scan is self.log[self.count]
        closed = self.count in self.closes
        self.count, self.bend = self.count + 1, self.bend / 2 if closed else self.bend
        return Placed(self.poses[-1], closed)

    def tracked(self, number):
        return TrackedScan(self.log[number], np.full(3, np.nan), 0, np.zeros(3), np.zeros(3))

    @property
    def poses(self):
        k = np.arange(self.count)
        return compose(np.stack([0 * k, 0.1 * self.bend * k, self.bend * k], -1), self.log.truth[k])

    def __len__(self):
        return self.count


def held_back(monkeypatch):
    """The thread that draws a map anew waits for the sign that is returned."""
    names = LiveMap.finish.__globals__  # the examples of a file may have loaded it once more
    go, real = threading.Event(), names["insert_placed"]

    def insert(*given, free):
        if threading.current_thread().name.startswith("new map"):
            go.wait(20)
        real(*given, free=free)

    monkeypatch.setitem(names, "insert_placed", insert)
    return go
