"""The README's code runs and gives what the text beside it says."""

import re
import shutil
from pathlib import Path

import numpy as np

import segmap

ROOT = Path(__file__).parents[1]
BLOCKS = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), re.DOTALL)


def test_ten_lines():
    """Names, shapes and figures that the README promises."""
    scope: dict[str, object] = {}
    exec(BLOCKS[0], scope)
    assert "1227 segments" in (ROOT / "README.md").read_text()
    assert len(scope["map"]) == 1227
    assert len(scope["small"]) == 266
    assert 0.7 < scope["rate"] < 0.9 and 0.7 < scope["kept"] < 0.9
    assert scope["walls"].shape[1:] == (2, 2)
    assert np.isfinite(scope["worst"])


def test_a_log_of_your_own(tmp_path, monkeypatch):
    """From a file, and from arrays."""
    monkeypatch.chdir(tmp_path)
    shutil.copy(ROOT / "data" / "malaga" / "malaga.log.gz", "my.log.gz")
    scope = {"segmap": segmap, "angles": np.zeros(3), "measured": [(0.0, np.ones(3))]}
    exec(BLOCKS[1] + "own = log\n" + BLOCKS[2], scope)
    assert len(scope["own"]) == 225
    assert len(scope["log"]) == 1
