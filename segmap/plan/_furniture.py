"""A run of wall that is furniture: how far the room before it goes on."""

from __future__ import annotations

import numpy as np
import scipy

from ..quadtree import FREE
from ..segments import length
from ._cells import JAMB_REACH_M
from ._doors import ROOM_REACH_M
from ._draft import Draft
from ._walls import FACE_TURN_RAD, HIDDEN_M, normals, thicknesses

#: Two faces that are nearer, metres, are of one thin wall, or of a leaf.
THINNEST_FURNITURE_M = 0.25
#: Behind furniture a wall is looked for so far, metres.
FURNITURE_REACH_M = 1.5
#: What ends so near to furniture, metres, belongs to it.
FURNITURE_MARGIN_M = 0.15


def go_through(draft: Draft, run: int) -> str:
    """The room before a run of wall goes on behind it; why that cannot be, or nothing.

    It goes to the next wall behind or, where one can walk past an end of the run into another room
    or a room lies right behind, both are one.
    """
    faces, grid, parts = draft.faces, draft.grid, draft.parts
    start, size, step = faces.segments[run, 0], float(length(faces.segments[run])), grid.side / 2
    lefts, way = normals(faces.segments), (faces.segments[run, 1] - start) / size
    front = lefts[run] * (faces.side[run] or 1)
    # metres along the run and before it: of all faces, and of squares around it
    x, y = (faces.segments - start) @ way, (faces.segments - start) @ front
    along = np.arange(step / 2 - FURNITURE_REACH_M, size + FURNITURE_REACH_M, step)
    ahead = np.arange(ROOM_REACH_M, -FURNITURE_REACH_M, -step)[:, None]
    squares = grid.squares(start + along[:, None] * way + ahead[..., None] * front)
    near, is_free, on_run = parts[squares], grid.kind[squares] == FREE, (along > 0) & (along < size)
    if not (is_room := near[ahead[:, 0] > 0][:, on_run] >= 0).any():
        return "no room before it"
    room = int(np.bincount(near[ahead[:, 0] > 0][:, on_run][is_room]).argmax())

    behind, depth = near[ahead[:, 0] < -grid.side][:, on_run], -ahead[ahead < -grid.side]
    first = (behind >= 0).argmax(0)
    beyond = behind[first, np.arange(behind.shape[1])]
    away = np.where(beyond >= 0, depth[first], np.inf)
    is_alone = (beyond == room).mean() > 0.5  # in one room

    off, facing = -y.mean(1), lefts @ front
    parallel = faces.wall & (abs(facing) > np.cos(FACE_TURN_RAD)) & (off <= FURNITURE_REACH_M)
    looks_away = parallel & (faces.side * facing < 0)
    back = looks_away & (off > 0)
    back &= (x.min(1) >= -JAMB_REACH_M) & (x.max(1) <= size + JAMB_REACH_M)
    deep = THINNEST_FURNITURE_M + off[back].max(initial=0)
    around = is_free & (ahead < THINNEST_FURNITURE_M) & (ahead > -deep)
    around &= (along > -JAMB_REACH_M) & (along < size + JAMB_REACH_M)
    pieces = scipy.ndimage.label(around)[0]
    past = around & np.isin(pieces, pieces[around & (near == room)]) & (near >= 0)
    past &= on_run & (ahead < THINNEST_FURNITURE_M - deep)  # behind it, and not beside
    rooms = {room} if is_alone else {room, *near[past].tolist()}
    goes = np.isin(beyond, [*rooms])

    walls = parallel & (off > np.where(looks_away, THINNEST_FURNITURE_M, grid.side))
    walls &= np.maximum(x.min(1) - size, -x.max(1)) <= HIDDEN_M
    walls &= ~back | (goes.mean() <= 0.5)
    thickness = thicknesses(faces.segments[faces.wall], faces.side[faces.wall])
    body = np.nanmedian(np.append(thickness, 0.0))  # of a wall whose other face was seen
    limit = (off - body * looks_away)[walls].min(initial=np.inf)
    goes = goes if len(rooms) > 1 else away < limit - grid.side
    goes &= goes.mean() > 0.5
    if not goes.any() and limit == np.inf:
        return "neither a wall nor a room behind it"
    rooms |= {*beyond[goes].tolist()}
    stop = np.zeros(len(along))
    stop[on_run] = np.where(goes, away, limit if limit < np.inf else 0)

    deep, hidden = stop.max(), (near < 0) & (ahead < FURNITURE_MARGIN_M)
    beside = hidden & is_free & (ahead > -deep) & (len(rooms) > 1)
    hidden = beside | (hidden & on_run & (ahead > -stop))
    parts[squares[0][hidden], squares[1][hidden]] = room
    if len(rooms) > 1:
        parts[np.isin(parts, [*rooms])] = parts.max() + 1
    own = (x.min(1) >= -FURNITURE_MARGIN_M) & (x.max(1) <= size + FURNITURE_MARGIN_M)
    own &= (y.max(1) <= FURNITURE_MARGIN_M) & (y.min(1) >= -deep - FURNITURE_MARGIN_M)
    own &= goes.any() | ~parallel | (off < deep - FURNITURE_MARGIN_M)
    own[run], faces.size[run] = True, size
    faces.wall[own & np.isfinite(faces.size)] = False
    return ""
