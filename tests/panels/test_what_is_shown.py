"""Each panel at each end of its controls: picture and texts are those of the library's calls."""

import ipywidgets as W
import numpy as np
import pytest
from driven_panels import LOG, RUNS, VIEW, WALLS, parts_of, press, view_of
from matplotlib.figure import Figure

from segmap import LaserScan, Log, load
from segmap.experiments import select, thresholds_of, thresholds_text
from segmap.panels import ComparePanel, LivePanel, Panel, ScanPanel
from segmap.plotting import (
    ERROR,
    RESULT,
    TRUTH,
    draw_before_after,
    draw_curves,
    draw_path,
    draw_scan,
    figure_png,
)
from segmap.poses import transform
from segmap.reduction import METHODS

DRIFTED = LOG.truth + np.array([0.3, -0.2, 0.1])
#: Two of its scans have no pose, the first one is of them.
SOME = Log("some", LOG.scans, [(np.nan,) * 3 if k in (0, 2) else p for k, p in enumerate(DRIFTED)])


def blank(width=480, height=360):
    """A point is a pixel."""
    return Figure((width / 72, height / 72), dpi=72, layout="constrained")


def shown(panel):
    """What readers without a kernel see; the words beside it are those of the panel."""
    bundle = panel._repr_mimebundle_()
    assert bundle[VIEW]["model_id"]
    words = bundle["text/plain"]
    assert words == repr(panel) and words.startswith(f"{type(panel).__name__}(")
    return bundle["image/png"]


def scanned(log, poses, color, step):
    known = np.flatnonzero(np.isfinite(poses).all(1))
    figure, k = blank(), int(known[step])
    ax, scan = figure.subplots(), log[k]
    cloud = np.concatenate([transform(poses[k], log[int(k)].points()) for k in known])
    ax.plot(*cloud[:: 1 + len(cloud) // 4000].T, ".", color="#cccccc", markersize=1)
    draw_path(poses[known], ax=ax, color=color)
    draw_scan(scan, poses[k], ax=ax, color=RESULT)
    after = f"scan {k} of {len(log)}, after {scan.time - log[0].time:.2f} s"
    return figure, [after, f"{scan.valid.sum()} of {len(scan)} beams valid"]


def compared(method, wanted):
    figure, own = blank(600, 270), select(RUNS, method=method)
    good = own[own["quality"] >= wanted / 100]
    run = good.loc[good["reduction"].idxmax()] if len(good) else own.loc[own["quality"].idxmax()]
    left, walls = METHODS[method].function(WALLS, **thresholds_of(run)), figure.subplots(1, 2)
    curves = draw_curves(RUNS, ax=walls[0], quality=wanted / 100)
    for line in curves.lines[1:]:
        line.set_alpha(0.25)
    at = [line.get_label() for line in curves.lines].index(method)
    for line in curves.lines[at - 1 : at + 1]:
        line.set(alpha=1.0, zorder=3)
    curves.set_ylim(0, 1)
    curves.legend(handles=[curves.lines[at]], loc="lower left")
    curves.plot(run["quality"], run["reduction"], "o", ms=12, mfc="none", color=ERROR, mew=2)
    draw_before_after(WALLS, left, ax=walls[1])
    kept = f"reduction {run['reduction']:.1%}: {len(left)} of {len(WALLS)} left"
    return figure, [thresholds_text(run), kept, f"quality {run['quality']:.1%}"]


@pytest.mark.parametrize(
    ("make", "wanted", "texts", "controls"),
    [
        (
            lambda: ScanPanel(LOG[1:], DRIFTED[1:]),
            lambda step: scanned(LOG[1:], DRIFTED[1:], RESULT, step),
            ("index", "valid"),
            {"step": (0, len(LOG) - 2)},
        ),
        (
            lambda: ScanPanel(SOME),
            lambda step: scanned(SOME, SOME.truth, TRUTH, step),
            ("index", "valid"),
            {"step": (0, 2)},
        ),
        (
            lambda: ScanPanel(Log("raw", LOG.scans)),
            lambda step: scanned(LOG, LOG.odometry, ERROR, step),
            ("index", "valid"),
            {"step": (0,)},
        ),
        (
            lambda: ComparePanel(WALLS, RUNS),
            compared,
            ("thresholds", "rate", "kept"),
            {"method": ("fusion", "mean_shift"), "wanted": (80, 98)},
        ),
    ],
)
def test_a_panel_shows_what_the_library_gives(make, wanted, texts, controls):
    """Catches a control that is not handed on, and whatever is drawn in another way."""
    panel = make()
    for values in zip(*controls.values(), strict=True):
        for name, value in zip(controls, values, strict=True):
            getattr(panel, name).value = value
        (figure, said), (finer, _) = (wanted(*values) for _ in range(2))
        assert [getattr(panel, name).value for name in texts] == said
        assert shown(panel) == figure_png(figure), values
        assert bytes(panel.picture.value) == figure_png(finer, finer=2)
    wide, high = figure.get_size_inches()
    limit = f"min({min(900, 144 * wide):.0f}px, {60 * wide / high:.0f}vh)"
    assert panel.picture.layout.max_width == limit
    players = [part for part in parts_of(view_of(panel)) if type(part) is W.Play]
    for play in players:
        play.playing = True
    panel.reset()
    assert not any(play.playing for play in players)
    first = [options[0] for options in controls.values()]
    assert [getattr(panel, name).value for name in controls] == first


def test_of_many_points_some_are_drawn(figures):
    """Catches a cloud that is drawn whole, or turned around, since every point takes time."""
    angles = np.linspace(0, 1, 4000)
    scan = LaserScan(1 + angles, angles, odometry=(0, 0, 0))
    ScanPanel(Log("many", [scan, scan]))
    drawn = np.array(figures[-1].axes[0].lines[0].get_data()).T
    assert np.array_equal(drawn, np.tile(scan.points(), (2, 1))[::3])


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
