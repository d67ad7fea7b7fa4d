"""Settings that all tests share."""

import os
import shutil
import sys
import tempfile
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings
from programs import program

#: Files of tests lie in memory where there is much of it: a slow disk doubles the time they take.
MEMORY = Path("/dev/shm")
if os.access(MEMORY, os.W_OK) and shutil.disk_usage(MEMORY).free > 4 << 30:
    os.environ.setdefault("TMPDIR", str(MEMORY))
    tempfile.tempdir = None  # whoever asked before

#: `make test` runs the tests of the library where its app cannot be imported.
if os.environ.get("SEGMAP_ALONE"):
    sys.modules["segmap_app"] = None  # type: ignore[assignment]

settings.register_profile("steady", deadline=None, derandomize=True)
settings.load_profile("steady")

#: Real logs that lie beside the project on our machines, and may not be copied into it.
SHARED = Path(__file__).resolve().parents[2] / "shared"


def shared_file(name: str) -> Path:
    """A file of the folder beside the project; skips the test where it is absent."""
    path = SHARED / name
    if not path.exists():
        pytest.skip(f"{name} is not here: it may not be distributed with the project")
    return path


def slow(*values: object) -> object:
    """A case of a parametrized test that only `make test-all` runs; `make test` runs others."""
    return pytest.param(*values, marks=pytest.mark.slow)


@contextmanager
def dask(folder):
    """An executor of a small cluster, where that is installed."""
    distributed = pytest.importorskip("distributed")
    options = {"dashboard_address": ":0", "local_directory": str(folder)}
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, **options) as cluster,
        distributed.Client(cluster) as client,
    ):
        yield client.get_executor()


class later:
    """A module that is imported when it is first used: every worker collects every test file."""

    def __init__(self, name: str) -> None:
        self._name = name

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):  # pytest asks everything that stands in a test file
            raise AttributeError(name)
        return getattr(import_module(self._name), name)


def without_pictures(monkeypatch):
    """Figures are drawn, and stored as a few bytes: a PNG takes longer than all the rest.

    The list of all figures that are to be stored, the last one last.
    """
    kept = []
    monkeypatch.setattr(
        "matplotlib.figure.Figure.savefig",
        lambda figure, file, **how: file.write(b"\x89PNG" + bytes(20)) and kept.append(figure),
    )
    return kept


@pytest.fixture
def only():
    """`only(names)`: no other reduction method is there, since all of them take minutes."""
    from segmap.reduction import METHODS

    whole = dict(METHODS)

    def keep(*names):
        for name in whole.keys() - {*names}:
            del METHODS[name]

    yield keep
    METHODS.clear()
    METHODS.update(whole)


@pytest.fixture
def no_png(monkeypatch):
    """A panel draws its figure, and makes no picture of it."""
    without_pictures(monkeypatch)


@pytest.fixture
def figures(monkeypatch):
    """All figures that are drawn for a picture: `figures[-1]` is what is seen now."""
    return without_pictures(monkeypatch)


@pytest.fixture
def agg():
    """Figures are drawn without a window, and closed."""
    import matplotlib.pyplot as plt

    with plt.rc_context({"backend": "agg"}):
        yield
        plt.close("all")


@pytest.fixture
def ax(agg):
    """Axes of a small figure."""
    from matplotlib.figure import Figure

    return Figure(figsize=(4, 3), dpi=50).subplots()


@pytest.fixture
def read(tmp_path):
    """Read a text, or a folder of texts by name, as if it were a log of that name."""
    from segmap import readers

    def read_texts(content, name="some.log", **settings):
        path = tmp_path / name
        if isinstance(content, str):
            path.write_text(content)
        else:
            path.mkdir()
            for file, part in content.items():
                (path / file).write_text(part)
        return readers.read(path, **settings)

    return read_texts


@pytest.fixture
def workloads():
    """The module of fixed synthetic workloads beside the project."""
    import importlib.util
    import sys

    path = shared_file("tools/workloads.py")
    spec = importlib.util.spec_from_file_location("workloads", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["workloads"] = module
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def run(tmp_path, monkeypatch, capsys):
    """Run a command in a folder of its own: exit code, output, what is said beside it."""
    main = program("segmap")

    monkeypatch.chdir(tmp_path)

    def command(*words):
        capsys.readouterr()
        try:
            code = main([str(word) for word in words])
        except SystemExit as end:
            code = end.code
        return code, *capsys.readouterr()

    return command
