"""One scan in several frames."""

from collections.abc import Mapping

from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from ..plotting import MAP, RESULT, axes_grid, draw_scan
from ..scans import LaserScan


def draw_frames(scan: LaserScan, frames: Mapping[str, ArrayLike], *, every: int = 30) -> list[Axes]:
    """Draw the same scan in several frames side by side, and the axes of each frame.

    Parameters
    ----------
    scan : LaserScan
    frames : mapping from name to (3,) array, metres and radians
        Where the robot stands in the frame of that name.
    every : int
        One beam in so many is drawn, from the sensor to its end.

    Returns
    -------
    list of Axes
        One a frame, in a new figure, all with the same limits.

    Examples
    --------
    >>> axes = draw_frames(LaserScan([1.0], [0.0]), {"robot": (0, 0, 0), "map": (3, 4, 0)})
    >>> [ax.get_title() for ax in axes]
    ['In the frame of the robot', 'In the frame of the map']
    >>> axes[1].lines[0].get_xdata().tolist()
    [4.0]
    """
    some = slice(None, None, every)
    few = LaserScan(
        scan.ranges[some], scan.angles[some], sensor_pose=scan.sensor_pose, max_range=scan.max_range
    )
    row = axes_grid([f"In the frame of the {name}" for name in frames], len(frames), (3.7, 4.0))
    for ax, pose in zip(row, frames.values(), strict=True):
        draw_scan(few, pose, ax=ax, beams=True)
        draw_scan(scan, pose, ax=ax, color=RESULT)
        ax.axhline(0, color=MAP, linewidth=0.5)
        ax.axvline(0, color=MAP, linewidth=0.5)
    return row
