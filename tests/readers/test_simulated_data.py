"""The simulated logs under data/: made anew from their seeds, read back, and what they show."""

import gzip
import hashlib
import importlib.util
from pathlib import Path

import pytest

DATA = Path(__file__).parents[2] / "data"
#: Name of a log -> its size is below so many bytes.
NAMES = {"room": 150_000, "corridor": 150_000, "clinic": 300_000}


@pytest.fixture(scope="module")
def script():
    spec = importlib.util.spec_from_file_location("simulate_data", DATA / "simulate.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("name", NAMES)
def test_a_simulated_log_can_be_made_anew_from_its_seed(name, script):
    """Catches a change of the simulation that leaves the committed log behind, or its checksum."""
    packed = (DATA / name / f"{name}.log.gz").read_bytes()
    assert len(packed) < NAMES[name] and packed[4:8] == bytes(4)  # no time stamp
    assert hashlib.sha256(packed).hexdigest() in (DATA / name / "README.md").read_text()
    lines = zip(
        gzip.decompress(packed).decode().splitlines(), script.text(name).splitlines(), strict=True
    )
    assert [k for k, (old, new) in enumerate(lines) if old != new] == []
