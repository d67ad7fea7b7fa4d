"""Files that segmap writes: trajectories, pose graphs, logs, maps; none that needs a framework.

Every file is written beside its place and then moved there: nobody ever reads half of it, and what
stood there before stays until the new one is complete. A name that ends in `.gz` is packed. A
folder that does not exist, or cannot be written to, is an OSError. Maps for ROS, sessions and
places on the earth are in `segmap_app.files`.
"""

from ._arrays import log_arrays, write_arrays
from ._graph import PoseGraph, write_graph
from ._maps import Classes, ros_classes, write_geojson, write_svg
from ._plan import write_plan
from ._segments import write_segments
from ._sheet import write_sheet
from ._trajectories import write_carmen, write_tum
from ._world import Direction, Frame

__all__ = [
    "Classes", "Direction", "Frame", "PoseGraph", "log_arrays", "ros_classes", "write_arrays",
    "write_carmen", "write_geojson", "write_graph", "write_plan", "write_segments", "write_sheet",
    "write_svg", "write_tum",
]  # fmt: skip
