"""What `import segmap` costs, beside numpy alone, each in fresh interpreters that take turns."""

import subprocess
import sys
from collections.abc import Iterator

from .measure import Row, in_turn


def rows() -> Iterator[Row]:
    ours, numpy = in_turn(lambda: fresh("segmap"), lambda: fresh("numpy"), repeat=7)
    bare = in_turn(lambda: fresh("sys"), lambda: fresh("sys"), repeat=7)[0]
    yield Row("import segmap", f"{1e3 * (ours - bare):.0f} ms", "<= 250 ms")
    yield Row(
        "import segmap / import numpy",
        f"{1e3 * (ours - bare):.0f} / {1e3 * (numpy - bare):.0f} ms "
        f"= {(ours - bare) / (numpy - bare):.2f}",
    )


def fresh(module: str) -> None:
    subprocess.run([sys.executable, "-c", f"import {module}"], check=True)
