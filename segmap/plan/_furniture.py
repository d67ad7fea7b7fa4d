"""A run of wall that is furniture: how far the room before it goes on."""

from __future__ import annotations

import numpy as np

from ..arrays import Array
from ..segments import length
from ._doors import ROOM_REACH_M
from ._draft import Draft, room_near
from ._walls import FACE_TURN_RAD, HIDDEN_M, normals

#: Behind furniture a wall is looked for so far, metres.
FURNITURE_REACH_M = 1.5
#: What ends so near to furniture, metres, belongs to it.
FURNITURE_MARGIN_M = 0.15


def go_through(draft: Draft, run: int, place: Array) -> str:
    """The room before a place on a run of wall goes on behind it; why that cannot be, or nothing.

    It goes to the next wall that faces it there or, where a room comes first, both are one.
    """
    faces, grid, parts = draft.faces, draft.grid, draft.parts
    start, size = faces.segments[run, 0], float(length(faces.segments[run]))
    lefts, way = normals(faces.segments), (faces.segments[run, 1] - start) / size
    front = lefts[run] * (faces.side[run] or 1)
    # metres along the run, and behind it, of the place and of all faces
    at = float(np.clip((place - start) @ way, 0, size))
    low, high = np.sort((faces.segments - start) @ way).T
    off, facing = (start - faces.segments) @ front, lefts @ front
    if (room := room_near(grid, parts, start + at * way + ROOM_REACH_M / 2 * front)) < 0:
        return "no room before it"

    is_parallel, depth = abs(facing) > np.cos(FACE_TURN_RAD), off.mean(1)
    is_next = faces.wall & is_parallel & (faces.side * facing >= 0) & (depth > grid.side)
    is_next &= (depth <= FURNITURE_REACH_M) & (np.maximum(low - size, -high) <= HIDDEN_M)
    nearest = np.lexsort([depth, np.maximum(low - at, at - high).clip(0), ~is_next])[0]
    wall = depth[nearest] if is_next[nearest] else np.inf

    along = np.arange(grid.side / 4, size, grid.side / 2)
    behind = np.arange(-FURNITURE_MARGIN_M, FURNITURE_REACH_M, grid.side / 2)
    squares = grid.squares(start + along[:, None, None] * way - behind[:, None] * front)
    is_room = (parts[squares] >= 0) & (behind > grid.side)
    first = np.where(is_room.any(1), is_room.argmax(1), -1)
    ends, beyond = behind[first], parts[squares][np.arange(len(along)), first]
    here = abs(along - at).argmin()
    is_joined = beyond[here] >= 0 and ends[here] < wall - grid.side
    if not is_joined and wall == np.inf:
        return "neither a wall nor a room behind it"
    if is_joined:
        rooms = [room, beyond[here]]
        ends = np.where(np.isin(beyond, rooms), ends, 0)
        parts[np.isin(parts, rooms)] = room = parts.max() + 1
    else:
        ends = np.where(beyond >= 0, ends, wall).clip(0, wall)
    hidden = (parts[squares] < 0) & (behind < ends[:, None])
    parts[squares[0][hidden], squares[1][hidden]] = room

    # what stands there is no wall, but for the next one and what is behind it
    margin = np.where(is_joined | ~is_parallel, 1, -1) * FURNITURE_MARGIN_M
    is_near = abs(along - (low + high)[:, None] / 2) <= FURNITURE_MARGIN_M
    is_inside = off.max(1) <= np.where(is_near, ends, 0).max(1) + margin
    is_inside &= (off.min(1) >= -FURNITURE_MARGIN_M) & np.isfinite(faces.size)
    is_inside &= (low >= -FURNITURE_MARGIN_M) & (high <= size + FURNITURE_MARGIN_M)
    is_inside[run], faces.size[run] = True, size
    faces.wall[is_inside] = False
    return ""
