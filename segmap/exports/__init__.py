"""What segmap writes for other programs: trajectories, pose graphs, logs with corrected poses,
maps.

Every file is written beside its place and then moved there: nobody ever reads half of it, and what
stood there before stays until the new one is complete. A name that ends in `.gz` is packed. A
folder that does not exist, or cannot be written to, is an OSError. `read_ros_map` reads
a map for ROS back, ours or another's.
"""

from ._arrays import write_arrays, write_session
from ._graph import write_graph
from ._maps import Classes, ros_classes, write_geojson, write_ros_map, write_svg
from ._plan import write_plan
from ._ros_maps import is_ros_map, read_ros_map
from ._segments import write_segments
from ._sheet import write_sheet
from ._trajectories import write_carmen, write_tum
from ._world import Earth, Frame, Grid, placed_at

__all__ = [
    "Classes", "Earth", "Frame", "Grid", "is_ros_map", "placed_at", "read_ros_map", "ros_classes",
    "write_arrays", "write_carmen", "write_geojson", "write_graph", "write_plan", "write_ros_map",
    "write_segments", "write_session", "write_sheet", "write_svg", "write_tum",
]  # fmt: skip
