"""Pose graphs in g2o files, with and without scans."""

from ._g2o import G2o
from ._graph import PoseGraph, read_graph

__all__ = ["GRAPH_FORMATS", "G2o", "PoseGraph", "read_graph"]

GRAPH_FORMATS = (G2o,)
