"""What `import segmap` costs, beside numpy alone, each in fresh interpreters that take turns."""

import os
import subprocess
import sys
from collections.abc import Iterator
from functools import partial

from .measure import Row, in_turn


def rows() -> Iterator[Row]:
    calls = [partial(fresh, module) for module in ("segmap", "numpy", "sys")]
    ours, numpy, bare = in_turn(*calls, repeat=7, clock=children)
    yield Row("import segmap", f"{1e3 * (ours - bare):.0f} ms", "<= 250 ms")
    yield Row(
        "import segmap / import numpy",
        f"{1e3 * (ours - bare):.0f} / {1e3 * (numpy - bare):.0f} ms "
        f"= {(ours - bare) / (numpy - bare):.2f}",
    )


def children() -> float:
    """CPU seconds of the processes that have ended."""
    times = os.times()
    return times.children_user + times.children_system


def fresh(module: str) -> None:
    subprocess.run([sys.executable, "-c", f"import {module}"], check=True)
