"""Logs that are tables: CSV, arrays, dumps of cheap sensors, Hokuyo text, CoreSLAM, Rawseeds."""

from ._csv import (
    read_csv,
)
