"""What make would do, for the tests of the README and of the browser."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]


def make(*arguments: str) -> list[str]:
    """Lines that make prints, free of the make that may run this test; `\\` joins lines."""
    if shutil.which("make") is None or sys.platform == "darwin":
        pytest.skip("make is not installed, or every machine of this kind has a display")
    env = {k: v for k, v in os.environ.items() if "MAKE" not in k and k != "MFLAGS"}
    run = subprocess.run(["make", *arguments], cwd=ROOT, env=env, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    return run.stdout.replace("\\\n", " ").splitlines()


def lab_command(port: int | str = "", display: str = "") -> str:
    """The line with which `make lab` starts JupyterLab."""
    lines = make("-n", "lab", f"DISPLAY={display}", "WAYLAND_DISPLAY=", f"PORT={port}")
    return next(line for line in lines if "-m jupyterlab" in line)


def app_command(port: int | str = "") -> str:
    """The line with which `make app` serves the workbench."""
    return next(line for line in make("-n", "app", f"PORT={port}") if "-m segmap app" in line)
