"""Logs that are tables: CSV, arrays, dumps of cheap sensors, Hokuyo text, CoreSLAM, Rawseeds."""

from .._text import Binary
from . import _csv, _hokuyo_text, _npz, _rawseeds, _rostopic
from ._coreslam import CoreSlam
from ._csv import read_csv
from ._csv_columns import head_of
from ._dumps import Ld19, RpLidar, RpLidarRecord
from ._hokuyo_text import HokuyoText
from ._npz import log_from_arrays
from ._rawseeds import Rawseeds, read_trajectory

__all__ = [
    "TABLE_FILES", "TABLE_FOLDERS", "TABLE_FORMATS", "CoreSlam", "HokuyoText", "Ld19", "Rawseeds",
    "RpLidar", "RpLidarRecord", "head_of", "log_from_arrays", "read_csv", "read_trajectory",
]  # fmt: skip

TABLE_FILES = (
    Binary("NPZ", _npz.claims, _npz.read),
    Binary("rostopic", _rostopic.rostopic_columns, _rostopic.read_rostopic),
    Binary("CSV", head_of, _csv.read),
)
TABLE_FOLDERS = (
    Binary("Rawseeds", _rawseeds.files_of, _rawseeds.read_folder),
    Binary("Hokuyo text", _hokuyo_text.numbered, _hokuyo_text.read_hokuyo_folder),
)
TABLE_FORMATS = (HokuyoText, CoreSlam, RpLidar, RpLidarRecord, Ld19, Rawseeds)
