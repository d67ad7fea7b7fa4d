"""Each panel at each end of its controls: picture and texts are those of the library's calls."""

import ipywidgets as W
import numpy as np
import pytest
from driven_panels import (
    LOG,
    RUNS,
    WALLS,
    assert_answers,
    parts_of,
    press,
    unpainted,
    view_of,
)
from matplotlib.figure import Figure

from segmap import Log, load
from segmap.experiments import select, thresholds_of, thresholds_text
from segmap.panels import ComparePanel, LivePanel, Panel, ScanPanel
from segmap.plotting import (
    ERROR,
    RESULT,
    TRUTH,
)
from segmap.poses import transform
from segmap.reduction import METHODS

DRIFTED = LOG.truth + np.array([0.3, -0.2, 0.1])
#: Two of its scans have no pose, the first one is of them.
SOME = Log("some", LOG.scans, [(np.nan,) * 3 if k in (0, 2) else p for k, p in enumerate(DRIFTED)])


@pytest.mark.parametrize(
    ("log", "given", "poses", "color"),
    [
        (LOG[1:], (DRIFTED[1:],), DRIFTED[1:], RESULT),
        (SOME, (), SOME.truth, TRUTH),
        (Log("raw", LOG.scans), (), LOG.odometry, ERROR),
    ],
)
def test_a_scan_is_shown_on_all_whose_poses_are_known(log, given, poses, color, figures):
    """Catches a scan or a pose beside the one that is chosen, and odometry that passes for truth.

    Of many points some are drawn, never turned around.
    """
    panel, known = ScanPanel(log, *given), np.flatnonzero(np.isfinite(poses).all(1))
    players = [part for part in parts_of(view_of(panel)) if type(part) is W.Play]
    cloud = np.concatenate([transform(poses[k], log[int(k)].points()) for k in known])
    for step in (0, len(known) - 1):
        panel.step.value = step
        scan, (points, way, *_) = log[k := int(known[step])], figures[-1].axes[0].lines
        drawn = np.array(points.get_data()).T
        assert np.array_equal(drawn, cloud[:: 1 + len(cloud) // 4000])
        assert np.array_equal(np.array(way.get_data()).T, poses[known, :2])
        assert way.get_color() == color
        after = f"scan {k} of {len(log)}, after {scan.time - log[0].time:.2f} s"
        assert panel.index.value == after
        assert panel.valid.value == f"{scan.valid.sum()} of {len(scan)} beams valid"
    for play in players:
        play.playing = True
    panel.reset()
    assert panel.step.value == 0 and not any(play.playing for play in players)


@unpainted
@pytest.mark.parametrize(("method", "wanted"), [("fusion", 80), ("mean_shift", 98)])
def test_the_run_is_shown_that_reduces_most_at_the_quality_asked_for(method, wanted):
    """Catches a control that is not handed on, and the figures of another run."""
    panel, own = ComparePanel(WALLS, RUNS), select(RUNS, method=method)
    panel.method.value, panel.wanted.value = method, wanted
    good = own[own["quality"] >= wanted / 100]
    run = good.loc[good["reduction"].idxmax()] if len(good) else own.loc[own["quality"].idxmax()]
    left = METHODS[method].function(WALLS, **thresholds_of(run))
    assert panel.thresholds.value == thresholds_text(run)
    kept = f"reduction {run['reduction']:.1%}: {len(left)} of {len(WALLS)} left"
    assert (panel.rate.value, panel.kept.value) == (kept, f"quality {run['quality']:.1%}")


@pytest.mark.parametrize(
    ("make", "control", "value"),
    [
        (lambda: ScanPanel(LOG), "step", 3),
        (lambda: ComparePanel(WALLS, RUNS), "wanted", 98),
    ],
)
def test_a_panel_answers_its_controls_and_is_shown_without_a_kernel(
    make, control, value, monkeypatch
):
    assert_answers(make(), control, value, monkeypatch)


# ------------------------------------------------------------------ zoom


@pytest.mark.parametrize(
    ("keys", "x", "y"),
    [
        ("", (3, 9), (-1, 4)),
        ("++", (4.5, 7.5), (0.25, 2.75)),
        ("+++--", (3.8787, 8.1213), (-0.26777, 3.26777)),
        ("++<^", (3.75, 6.75), (0.875, 3.375)),
        ("++vvv", (4.5, 7.5), (-1, 1.5)),
        ("+" * 30, (6 - 3 / 64, 6 + 3 / 64), (1.5 - 2.5 / 64, 1.5 + 2.5 / 64)),
        ("+++0", (3, 9), (-1, 4)),
    ],
)
def test_each_button_shows_its_part_of_the_whole(figures, keys, x, y):
    """Catches a step that is too large, a part beyond the drawing, and a press without effect."""

    class Three(Panel):
        """Two maps, and a plot that is none."""

        def __init__(self):
            self._assemble(())

        def _draw(self, figure: Figure) -> None:
            for ax, aspect in zip(figure.subplots(1, 3), (1, 1, "auto"), strict=True):
                ax.set(aspect=aspect, xlim=(3, 9), ylim=(-1, 4))

    panel = Three()
    press(view_of(panel), keys)
    left, right, plot = figures[-1].axes
    for ax in (left, right):
        assert ax.get_xlim() == pytest.approx(x, abs=1e-3)
        assert ax.get_ylim() == pytest.approx(y, abs=1e-3)
    assert (plot.get_xlim(), plot.get_ylim()) == ((3, 9), (-1, 4))


# ------------------------------------------------------------------ a live map


def test_the_rate_is_that_of_the_last_twenty_scans():
    log = load("room")[:1]
    panel = LivePanel(log)
    for time in (*range(9), *np.arange(9, 19, 0.5)):
        panel.take(log[0].__class__(log[0].ranges, log[0].angles, time=time))
    assert panel.rate.value == "2.0 scans a second"
    still = LivePanel(log)
    still.run(1)
    assert still.rate.value == "0.0 scans a second"
