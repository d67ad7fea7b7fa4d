"""Frames of a robot as ROS tells of them (tf): where the laser sits, and how the robot moved."""

from __future__ import annotations

from typing import Any

import numpy as np

from segmap.arrays import Array
from segmap.readers.mounting import in_space, level
from segmap.readers.raw_scans import Track

#: A laser that moves by more than this on its robot, in metres and radians, has no place on it.
FIXED_LASER = 0.01, np.radians(1)
#: What the name of the frame of odometry holds.
ODOMETRY_FRAME = "odom"
#: What the name of the robot's own frame holds.
BASE_FRAME = "base"


class Frames:
    """Poses of frames in the frame above each: of what stands still, and of what moves.

    Poses are (4, 4) arrays: they carry points of a frame into the one above it.
    """

    def __init__(self) -> None:
        self.above: dict[str, str] = {}
        self.poses: dict[str, Array] = {}
        self.moving: set[str] = set()
        self.tracks: dict[tuple[str, str], Track] = {}

    def take(self, transform: Any, time: float, after: int | None = None) -> None:
        """Take in one transform: geometry_msgs/TransformStamped, its time, and scans before it."""
        parent, child = strip(transform.header.frame_id), strip(transform.child_frame_id)
        place, turn = transform.transform.translation, transform.transform.rotation
        pose = in_space((place.x, place.y, place.z), (turn.w, turn.x, turn.y, turn.z))
        first = self.poses.setdefault(child, pose)
        step = np.linalg.inv(first) @ pose
        turn = np.arccos(np.clip((np.trace(step[:3, :3]) - 1) / 2, -1, 1))
        if (
            self.above.setdefault(child, parent) != parent
            or np.abs(step[:3, 3]).max() > FIXED_LASER[0]
            or turn > FIXED_LASER[1]
        ):
            self.moving.add(child)
        if first is pose or child in self.moving or ODOMETRY_FRAME in parent:
            self.tracks.setdefault((child, parent), Track()).add(time, level(pose), after)

    def chain(self, frame: str) -> dict[str, Array]:
        """The frame itself and all above it, each with the pose of the frame in it."""
        pose = np.eye(4)
        poses = {frame: pose}
        while self.above.get(frame, frame) not in poses:
            pose, frame = self.poses[frame] @ pose, self.above[frame]
            poses[frame] = pose
        return poses

    def place(self, laser: str, base: str) -> Array | None:
        """The laser's pose in the frame of the robot; None where nothing links the two.

        It is a ValueError where something between the two moves.
        """
        up, down = self.chain(strip(laser)), self.chain(strip(base))
        common = next((frame for frame in up if frame in down), None)
        if common is None:
            return None
        between = [f for chain in (up, down) for f in list(chain)[: list(chain).index(common)]]
        if moving := [frame for frame in between if frame in self.moving]:
            raise ValueError(f"expected a laser that is fixed to {base}, but {moving[0]} moves")
        return np.linalg.inv(down[common]) @ up[common]

    def base_of(self, laser: str) -> str:
        """The robot's frame where no odometry names it: the first "base" above the laser."""
        return next((f for f in self.chain(strip(laser)) if _is(f, BASE_FRAME)), strip(laser))

    def carries(self, base: str, laser: str) -> bool | None:
        """Whether the laser is fixed to a frame; None where nothing tells of one of them."""
        try:
            if self.place(laser, base) is not None:
                return True
        except ValueError:
            return False
        return False if {strip(base), strip(laser)} <= {*self.above, *self.above.values()} else None

    def drive(self, laser: str) -> tuple[str, str, Track]:
        """The robot's frame, the one above in which it moves, and its poses there.

        That is the lowest link that moves, from the robot's frame on, and that of an odometry
        before others; where nothing is known of the laser, that of any odometry.
        """
        up = list(self.chain(strip(laser)))
        base = next((k for k, frame in enumerate(up) if _is(frame, BASE_FRAME)), 0)
        anywhere = [child for child, above in self.tracks if ODOMETRY_FRAME in above]
        for frame in up[base:] if len(up) > 1 else anywhere:
            links = [link for link in self.tracks if link[0] == frame]
            candidates = [link for link in links if ODOMETRY_FRAME in link[1]] or links
            if candidates and (frame in self.moving or ODOMETRY_FRAME in candidates[0][1]):
                link = max(candidates, key=lambda each: len(self.tracks[each].times))
                return *link, self.tracks[link]
        return "", "", Track()


def strip(frame: str) -> str:
    """The name of a frame: ROS 1 may write it with a slash before it."""
    return frame.strip("/")


def _is(frame: str, word: str) -> bool:
    """Whether the last part of a name begins with a word: `robot1/base_link` is a base."""
    return frame.split("/")[-1].startswith(word)
