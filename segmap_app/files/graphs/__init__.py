"""Pose graphs in g2o files, with and without scans."""

from ._g2o import G2o
from ._graph import read_graph

__all__ = ["G2o", "read_graph"]
