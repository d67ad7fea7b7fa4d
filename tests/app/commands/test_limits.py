"""Commands on results made by hand: what they say to the letter, and what they do at each limit."""

import inspect
import io
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import tqdm
from programs import program

import segmap
from segmap import exports, quadtree, reduction
from segmap.alignment import Alignment, Verdict

main = program("segmap")

# ------------------------------------------------------------------------------- words


class Terminal(io.StringIO):
    def isatty(self):
        return True


class AtOnce(tqdm.tqdm):
    def __init__(self, *work, **given):
        super().__init__(*work, **given | {"delay": 0, "mininterval": 0})


@pytest.mark.parametrize(
    "words",
    [
        ("map", "room", "--align", "pose_graph", "-o", "it.PNG"),
        ("locate", "it.npz", "room"),
        ("merge", "room", "room", "--method", "none"),
    ],
)
def test_long_work_moves_a_bar_on_a_terminal(run, monkeypatch, words):
    """Catches a bar that stands still for the whole alignment, one that stays, and two at once."""
    log = segmap.load("room")
    quadtree.build_map(log, log.truth, resolution=0.05).save("it.npz")
    monkeypatch.setattr(sys, "stderr", screen := Terminal())
    monkeypatch.setattr("tqdm.std.tqdm.monitor_interval", 0)
    monkeypatch.setattr("tqdm.tqdm", AtOnce)
    monkeypatch.setattr("segmap.progress.FIRST_ESTIMATE_S", 0.0)
    assert run(*words)[0] == 0
    scans = [int(k) for k in re.findall(r"placing scan (\d+) of 61 \|", screen.getvalue())]
    order = list(dict.fromkeys(scans))
    assert len(order) > 3 and order == sorted(order)
    shown = screen.getvalue()
    assert "/3" not in shown and "\n" not in shown
    assert re.search(r"\| \d+ s left", screen.getvalue())
    early = re.findall(r"placing scan [123] of 61 \|[^|\r]*\| ([^\r]*left)", screen.getvalue())
    assert early == [], "of 61 scans these are less than 5 %"
    assert screen.getvalue().endswith(" \r")


@pytest.mark.parametrize(
    ("grade", "placed", "strict", "code"),
    [("good", 9, 0.9, 0), ("good", 8, 0.9, 3), ("doubtful", 10, 1.0, 0), ("not a map", 10, 0.0, 3)],
)
def test_strict_is_met_by_just_as_many(run, monkeypatch, grade, placed, strict, code):
    """Catches 9 of 10 scans that are fewer than 0.9, and --force that is not asked."""
    verdict = Verdict(grade, "as said", placed, 10)
    monkeypatch.setattr(Alignment, "verdict_on", lambda found, map: verdict)
    words = ("map", "room", "--align", "odometry", "--strict", strict, "-o", "it.svg")
    ended, said, _ = run(*words)
    assert (ended, Path("it.svg").exists()) == (code, code == 0)
    assert ("(--strict asks" in said) == (code == 3 and grade == "good")
    assert run(*words, "--force")[0] == code and Path("it.svg").exists()


# ------------------------------------------------------------------------------- locate


# ------------------------------------------------------------------------------- compare
def made_up(monkeypatch, quality, seconds=lambda value: 0.1):
    """`compare` asks for runs, and is given these; what it asks for, as parts of the default."""
    asked = []

    def sweep(maps, methods, settings):
        ((name, map),), (method,) = maps.items(), methods
        varies = reduction.METHODS[method].varies
        default = inspect.signature(getattr(reduction, method)).parameters[varies].default
        (value,) = settings[method][varies]
        asked.append(round(value / default, 6))
        row = {"map": name, "filtered": 0.0, "method": method, varies: value, "n_before": len(map)}
        kept = quality(method, asked[-1])
        gone = 1 - kept if kept == kept else 0.99
        left = round((1 - gone) * len(map))
        row |= {"n_after": left, "reduction": gone, "quality": kept, "seconds": seconds(asked[-1])}
        return pd.DataFrame([row])

    monkeypatch.setattr("segmap.experiments.sweep", sweep)
    exports.write_carmen("it.log", segmap.load("room")[:4])
    return asked


TWICE, ROOT = [1, 2, 4, 8, 16, 32], 2**0.5


@pytest.mark.parametrize(
    ("limit", "slow_at", "seconds", "tried"),
    [
        (3.0, np.inf, 0, [1, 2, 4, 2 * ROOT, 2 * ROOT * ROOT**0.5]),
        (0.3, np.inf, 0, [1, 0.5, 0.25, 0.25 * ROOT, 0.25 * ROOT**0.5]),
        (1e9, np.inf, 0, TWICE),
        (0, np.inf, 0, [1 / k for k in TWICE]),
        (31, np.inf, 0, [*TWICE, 16 * ROOT, 16 * ROOT * ROOT**0.5]),
        (1e9, 4, 20.0, TWICE),
        (1e9, 4, 20.1, [1, 2, 4]),
        (1e9, 0, 99.0, [1]),
    ],
)
def test_a_method_is_sought_by_doubling_and_then_between(
    run, monkeypatch, limit, slow_at, seconds, tried, only
):
    """Catches a search that ends beside the quality, or never, or that waits for a slow method."""
    only("fusion")
    asked = made_up(
        monkeypatch,
        lambda method, value: 0.9 if value <= limit else 0.5,
        lambda value: seconds if value >= slow_at else 0.1,
    )
    assert run("compare", "it.log", "--quality", "90")[0] == 0
    assert asked == pytest.approx(tried, abs=1e-5)


# ---------------------------------------------------------------------------- streams
NAMED = "caf\u00e9 \u2192 \u0416.log"
#: What an old Windows and a machine without a language have.
TERMINALS = (
    {"PYTHONIOENCODING": "cp1252"},
    {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"},
)


@pytest.mark.parametrize("terminal", TERMINALS)
def test_a_name_that_a_terminal_cannot_say_never_ends_the_work(terminal, tmp_path):
    """Catches "'charmap' codec can't encode", and work that is lost for it."""
    exports.write_carmen(tmp_path / NAMED, segmap.load("room")[:3])
    words = [NAMED, "nowhere \u0416.log", "-o", "{name}.tum"]
    found = subprocess.run(
        [sys.executable, "-m", "segmap", "convert", *words],
        cwd=tmp_path, env=os.environ | terminal, capture_output=True, check=False,
    )  # fmt: skip
    said, beside = found.stdout.decode("latin-1"), found.stderr.decode("latin-1")
    assert "codec" not in beside and "Traceback" not in beside and found.returncode == 1
    assert "3 scans" in said
    assert "\\u0416.log" in beside or "\\udcd0\\udc96.log" in beside
    assert len(list(tmp_path.glob("*.tum"))) == 1
