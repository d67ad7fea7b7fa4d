"""A map that grows while the laser turns."""

from __future__ import annotations

import contextlib
import threading
from collections import deque
from collections.abc import Generator, Iterable, Sized
from itertools import islice

import ipywidgets as W
import numpy as np
from numpy.typing import ArrayLike

from .. import arrays
from ..arrays import Array, Metres, checked
from ..carried import CarriedMap
from ..compiled import work_time
from ..display import plural
from ..extraction import extract_polylines
from ..matching import LiveMap, Step
from ..plotting import ERROR
from ..poses import transform
from ..quadtree import QuadtreeMap
from ..reduction import LiveReduction
from ..scans import LaserScan
from ..sensors import Newest, SensorError, SpinningLaser, UrgSensor
from ._base import Panel, slider, text
from ._live_picture import LivePicture

#: Number of scans over which the rate is measured.
RATE = 20
#: Seconds that stop waits for a silent or lost sensor; its thread then ends by itself.
LEAVE = 3.0
#: Side of the smallest leaves that rays split off, in sides of the smallest leaf.
COARSE = 16


#: A sensor, or what gives scans.
Source = UrgSensor | SpinningLaser | Iterable[LaserScan]


class LivePanel(Panel):
    """The scan, the segments and the quadtree of a moving sensor, as they arrive.

    Start and stop are buttons. One thread reads scans, another maps and draws the newest; scans
    that arrive meanwhile are left out, never queued. Stop it before you use the sensor elsewhere.

    A pose graph places the scans. While `loops` is ticked it closes loops: where the robot comes
    back, the map is made anew from corrected poses, in a third thread, and the old one is shown
    until then. The walls, kept reduced by `LiveReduction`, are drawn as thin lines. Scans of a
    `SpinningLaser` are carried to the middle of their turns. A change begins a new map where the
    robot now is.

    Parameters
    ----------
    source
        A sensor, or what gives scans.
    resolution
        Side of the smallest leaves: with coarser ones the poses drift sooner. Rays split leaves
        down to sixteen times as much, so that what was not seen is not white.
    start
        Pose of the first scan.

    Attributes
    ----------
    tolerance : slider
        Of the segments.
    count, leaves, rate, dropped, graph, place, state : labels
        `place` says whether the last scan was found on the map, and how often the robot was lost.
    map : QuadtreeMap
    seconds : float
        Duration of the last step, drawing included.

    Examples
    --------
    >>> from segmap import load
    >>> panel = LivePanel(load("room"))
    >>> panel.run(3)
    >>> panel
    LivePanel(3 scans: 11 segments)
    """

    @checked
    def __init__(
        self,
        source: Source,
        *,
        resolution: Metres = 0.02,
        start: ArrayLike = (0.0, 0.0, 0.0),
    ) -> None:
        self.source, self._resolution = _checked_source(source), resolution
        self._begin: Array = arrays.pose(start, "start")
        self.seconds, self.taken, self.lost = 0.0, 0, 0
        self._scan: LaserScan | None = None
        self._step: Step | None = None
        self._newest: Newest | None = None
        self._times: deque[float] = deque(maxlen=RATE)
        self._thread: threading.Thread | None = None
        self._stopping, self._drawing = threading.Event(), threading.RLock()
        self.start, self.stop = W.Button(description="start"), W.Button(description="stop")
        self.start.on_click(self._start)
        self.stop.on_click(self._stop)
        self.tolerance = slider("tolerance", 0.03, 0.005, 0.10, 0.005)
        self.loops = W.Checkbox(value=True, description="close loops", indent=False)
        self.loops.observe(self._choose, names="value")
        self.count, self.leaves, self.rate, self.dropped = (text() for _ in range(4))
        self.graph, self.place, self.state = text(), text(), text()
        self._picture = LivePicture()
        self._choose()
        self._assemble(
            (self.start, self.stop),
            (self.tolerance, self.loops),
            (self.count, self.leaves),
            (self.rate, self.dropped),
            (self.graph, self.place),
            self.state,
        )

    def run(self, scans: int) -> None:
        """Take so many scans in the calling thread, and leave none out; then end the map."""
        scans = arrays.whole(scans, "scans", least=0)
        _warm_up()
        with contextlib.closing(_scans_of(self.source)) as stream:
            for scan in islice(stream, scans):
                self.take(scan)
        self.finish()

    def take(self, scan: LaserScan) -> None:
        """Match a scan with the map, insert it, and draw."""
        begun = work_time()
        with self._drawing:
            self._match(scan)
            self.taken += 1
            self.lost += self._step is not None and not self._step.found
            self._times.append(scan.time)
            self._redraw()
        self.seconds = work_time() - begun

    def finish(self) -> None:
        """Wait until the map shows all scans at their corrected poses, and draw it."""
        self._live.finish()
        self._redraw()

    @property
    def map(self) -> QuadtreeMap:
        """The map as it is now."""
        return self._live.map

    def _choose(self, change: object = None) -> None:
        """Begin a new map, by the choice that was made."""
        with self._drawing:
            self._begin = self._begin if self._step is None else self._step.pose
            coarse, moving = COARSE * self._resolution, isinstance(self.source, SpinningLaser)
            map = QuadtreeMap(resolution=self._resolution, free_resolution=coarse)
            self._live = CarriedMap(
                moving=moving, loops=self.loops.value, map=map, start=self._begin
            )
            self._step, self.lost = None, 0

    # --------------------------------------------------------------------- threads
    def _start(self, button: object = None) -> None:
        if self._thread is None or not self._thread.is_alive():
            self._stopping.clear()
            self._thread = threading.Thread(target=self._follow, name="live map", daemon=True)
            self._thread.start()

    def _stop(self, button: object = None) -> None:
        self._stopping.set()
        if self._thread is not None:
            self._thread.join(LEAVE)
            if self._thread.is_alive():
                self.state.value = "stops when the sensor answers or is given up"

    def _follow(self) -> None:
        self.state.value = "getting ready: the first time on a machine it compiles, for a minute"
        _warm_up()
        self.state.value = "running"
        try:
            with Newest(_scans_of(self.source)) as self._newest:
                for scan in self._newest:
                    self.take(scan)
                    if self._stopping.is_set():
                        break
        except (SensorError, ValueError) as fault:
            self.state.value = str(fault)
        except Exception as fault:
            self.state.value = f"{type(fault).__name__}: {fault}"
        else:
            self.state.value = "the map is made ready"
            self.finish()
            self.state.value = "stopped"

    def _match(self, scan: LaserScan) -> None:
        """Match and insert; a scan that fails, or is interrupted, is left out."""
        try:
            self._step = self._live.add(scan)
        except BaseException:
            self._picture = LivePicture()  # half a scan may be in the map
            raise
        self._scan = self._live.graph.tracked(len(self._live.graph) - 1).scan

    # --------------------------------------------------------------------- drawing
    def _redraw(self, change: object = None) -> None:
        with self._drawing:
            now = self._step
            if now is not None:
                self._tell_place(now)
            if self._scan is None or now is None or not np.isfinite(now.pose[0]):
                self.picture.value = self._picture.png()
                return
            own = extract_polylines(
                self._scan.points(), tolerance=self.tolerance.value, closed=self._scan.whole_turn
            )
            segments = transform(now.pose, own.reshape(-1, 2)).reshape(-1, 2, 2)
            self._tell(len(segments))
            walls = self._live.walls
            reduced = None if walls is None else walls.segments
            self._picture.show(self.map, self._scan, now.pose, segments, reduced)
            self.picture.value = self._picture.png()

    def _tell_place(self, now: Step) -> None:
        advice = self._live.advice
        self.place.style.text_color = ERROR if advice or not now.found else None
        lies = f"{now.overlap:.0%} of the scan lies on the map"
        before = f"; {plural(self.lost, 'scan')} lost on this map" if self.lost else ""
        self.place.value = f"{advice or ('found' if now.found else 'LOST')}: {lies}{before}"

    def _tell(self, segments: int) -> None:
        self.count.value = f"{segments} segments"
        self.leaves.value = f"{3 * self.map.tree.used + 1} leaves"
        self.graph.value = repr(self._live.graph)
        passed = self._times[-1] - self._times[0]
        rate = (len(self._times) - 1) / passed if passed > 0 else 0.0
        self.rate.value = f"{rate:.1f} scans a second"
        lost = self.source.dropped if isinstance(self.source, UrgSensor) else 0
        left_out = 0 if self._newest is None else self._newest.skipped
        self.dropped.value = f"{lost} dropped, {left_out} left out"

    def __repr__(self) -> str:
        counts = f": {self.count.value}" if self.taken else ""
        return f"LivePanel({self.taken} scans{counts})"


def _scans_of(source: Source) -> Generator[LaserScan, None, None]:
    yield from source.scans() if isinstance(source, UrgSensor | SpinningLaser) else source


def _checked_source(source: Source) -> Source:
    """A sensor, or what gives scans; those of a list are looked at, others when they come."""
    if isinstance(source, UrgSensor | SpinningLaser):
        return source
    listed = source if isinstance(source, Sized) and arrays.is_iterable(source) else ()
    if not arrays.is_iterable(source) or not all(isinstance(scan, LaserScan) for scan in listed):
        got = arrays.brief(source)
        raise ValueError(f"source must be a sensor, or give scans (LaserScan), got {got}")
    return source


def _warm_up() -> None:
    """Load what is compiled, and draw once, before the laser is on and scans wait for it."""
    angles = np.radians(np.arange(0, 360, 5.0))
    square = LaserScan(1 / np.maximum(np.abs(np.cos(angles)), np.abs(np.sin(angles))), angles)
    segments = extract_polylines(square.points(), closed=square.whole_turn)
    map = QuadtreeMap(resolution=0.1, free_resolution=0.1 * COARSE)
    live = LiveMap(map=map, walls=LiveReduction(every=1))
    picture = LivePicture()
    for step in (live.add(square), live.add(square)):
        picture.show(map, square, step.pose, segments)
        picture.png()
