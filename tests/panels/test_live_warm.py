"""A live sensor is asked for scans once everything is compiled: its laser is still off then."""

import subprocess
import sys

import pytest

#: In a process of its own, where nothing is loaded: kernels and their signatures, before the first
#: scan is asked for and after the last.
CODE = """
import gc, sys
import numpy as np
from segmap import load
from segmap.compiled import Compiled

def loaded():
    kernels = [k for k in gc.get_objects() if type(k) is Compiled]
    own = [(k.plain.__qualname__, getattr(k._fast, "signatures", ())) for k in kernels]
    return {(name, str(one)) for name, signatures in own for one in signatures}

log, before = load("room")[:8], set()

def live():
    before.update(loaded())
    yield from log

from segmap.panels import LivePanel
panel = LivePanel(live())
panel._follow()
assert panel.taken, panel.state.value
late = sorted(loaded() - before)
print(len(before), late)
"""


def test_nothing_compiles_between_the_first_scan_and_the_last():
    """Catches the first live poses, 0.7 m off, of a machine that compiles while the robot moves."""
    pytest.importorskip("ipywidgets", reason="panels need ipywidgets")
    command = [sys.executable, "-c", CODE]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    count, _, late = done.stdout.partition(" ")
    assert int(count) >= 4 and late.strip() == "[]"
