"""What loops change in place, when two threads use it at once: nothing breaks, nothing is torn."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import slow
from hammered import KINDS

HAMMERED = Path(__file__).parents[1] / "hammered.py"
PAIRS = [f"{kind}, {second}" for kind in KINDS for second in ("writers", "writer and reader")]
SOME = ["map, writers", *PAIRS[1::2]]  # in one process, which imports and loads once


@pytest.mark.parametrize(
    "pairs, seed, seconds",
    [(SOME, 0, 0.1), *(slow([pair], seed, 60) for pair in PAIRS for seed in range(5))],
)
def test_two_threads_on_one_object(pairs, seed, seconds):
    """Catches a loop that reads arrays which another thread rewrites: the process dies, hangs, or
    the reader sees half a scan; and two methods that wait for each other's lock."""
    words = [sys.executable, "-X", "faulthandler", str(HAMMERED), str(seed), str(seconds), *pairs]
    environment = os.environ | {"SEGMAP_THREADS": "1"}
    done = subprocess.run(
        words, capture_output=True, text=True, timeout=240 + seconds, check=False, env=environment
    )
    assert done.returncode == 0, done.stderr[-3000:]
    steps = [int(word) for word in done.stdout.split()]
    assert len(steps) == 2 * len(pairs) and min(steps) > 0
