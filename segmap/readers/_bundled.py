"""The logs that come with segmap, and one that comes with another package."""

from __future__ import annotations

import tempfile
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path

from .. import arrays

PACKAGE = Path(__file__).parents[1]
#: In a clone the data lies beside the package, in an installed wheel inside it.
DATA_FOLDERS = (PACKAGE.parent / "data", PACKAGE / "data")
#: MIT Killian Court (M. Bosse, J. Leonard): 3873 scans with corrected poses.
KILLIAN = "killian"


@contextmanager
def open_bundled(name: str) -> Iterator[Path]:
    """The file of a bundled log: `data/<name>/<name>.log.gz`."""
    if name == KILLIAN:
        other = find_spec("rtbdata")
        if other is None or not other.submodule_search_locations:
            raise ValueError("the log 'killian' is in another package: pip install rtb-data")
        archive = Path(other.submodule_search_locations[0]) / "data" / "killian.g2o.zip"
        with zipfile.ZipFile(archive) as packed, tempfile.TemporaryDirectory() as folder:
            yield Path(packed.extract("killian.g2o", folder))
        return
    paths = [path for place in reversed(DATA_FOLDERS) for path in place.glob("*/*.log.gz")]
    logs = {path.parent.name: path for path in paths if path.name == f"{path.parent.name}.log.gz"}
    if not isinstance(name, str) or name not in logs:
        names = ", ".join(map(repr, sorted(logs))) or "none"
        raise ValueError(
            f"name must be that of a bundled log ({names}), got {arrays.brief(name)}: "
            "segmap.read(path) reads a file of yours"
        )
    yield logs[name]


def data_file(name: str) -> Path:
    """A file or folder that comes with segmap, in a clone or in an installed wheel."""
    arrays.file(name, "name")
    for place in DATA_FOLDERS:
        if (path := place / name).exists():
            return path
    raise ValueError(f"segmap's data/{name} is missing: install segmap again")
