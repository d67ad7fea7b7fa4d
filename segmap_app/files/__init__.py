"""Files of other programs, and sessions: no method of mapping is here.

Bags of ROS, pose graphs of g2o, maps for ROS, places on the earth. `FORMATS` are the logs among
them: the entry point `segmap.formats` makes them known to `segmap.read`.
"""

from ._places import Earth, Grid, placed_at
from ._ros_maps import is_ros_map, read_ros_map, write_ros_map
from ._session import Session, read_session, write_session
from .bags import BAG, kind_of, read_bag, recordings
from .graphs import G2o, read_graph

__all__ = [
    "BAG", "FORMATS", "Earth", "G2o", "Grid", "Session", "is_ros_map", "kind_of", "placed_at",
    "read_bag", "read_graph", "read_ros_map", "read_session", "recordings", "write_ros_map",
    "write_session",
]  # fmt: skip

#: Formats of logs, as `segmap.readers` has its own.
FORMATS = (BAG, G2o)
