"""Pose graphs in g2o files, with and without scans."""

from ._graph import (
    PoseGraph,
    read_graph,
)
