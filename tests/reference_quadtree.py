"""The quadtree of B 4 written as the prose says it: one dictionary of leaves, no tricks."""

import math

import numpy as np


class Literal:
    """Leaves `(x, y, side)` in cells from the first corner -> `[vis, occ]`."""

    def __init__(self, cells, largest=2**16):
        self.x = self.y = 0
        self.side, self.largest = cells, largest
        half = cells // 2
        self.leaves = {(x, y, half): [0, 0] for x in (0, half) for y in (0, half)}

    def holds(self, x, y):
        return self.x <= x < self.x + self.side and self.y <= y < self.y + self.side

    def grow(self, x, y):
        while not self.holds(x, y):
            assert self.side < self.largest
            s = self.side
            to_x = self.x - s if x < self.x else self.x
            to_y = self.y - s if y < self.y else self.y
            for qx in (to_x, to_x + s):
                for qy in (to_y, to_y + s):
                    if (qx, qy) != (self.x, self.y):
                        self.leaves[(qx, qy, s)] = [0, 0]
            self.x, self.y, self.side = to_x, to_y, 2 * s

    def leaf(self, x, y):
        side = self.side
        while side >= 1:
            key = (self.x + (x - self.x) // side * side, self.y + (y - self.y) // side * side, side)
            if key in self.leaves:
                return key
            side //= 2
        raise AssertionError("no leaf")

    def split(self, x, y, least=1):
        while (key := self.leaf(x, y))[2] > least:
            counts = self.leaves.pop(key)
            for corner in quarters(key):
                self.leaves[corner] = self.at_first(counts)

    def at_first(self, counts):
        return [1, 0]

    def insert(self, sensor, ends, free=()):
        for cell in [sensor, *ends, *free]:
            self.grow(*cell)
        for end in ends:
            self.split(*end)
        for end in ends:
            counts = self.leaves[self.leaf(*end)]
            counts[0] += counts[1] > 0 or counts[0] == 0
            counts[1] += 1
        rays = [unmasked(sensor, end) for end in ends] + [bresenham(sensor, end) for end in free]
        self.make_way(rays)
        for ray in rays:
            for key in {self.leaf(*cell) for cell in ray}:
                self.leaves[key][0] += 1

    def make_way(self, rays):
        pass


class Finer(Literal):
    """With `free_resolution`, in cells: rays split, splits hand on, equal children join."""

    def __init__(self, cells, free, largest=2**16):
        super().__init__(cells, largest)
        self.free = free

    def at_first(self, counts):
        assert counts[1] == 0
        return list(counts)

    def make_way(self, rays):
        for ray in rays:
            for cell in ray:
                self.split(*cell, least=self.free)

    def insert(self, sensor, ends, free=()):
        super().insert(sensor, ends, free)
        while any([self.join(key) for key in list(self.leaves)]):
            pass

    def join(self, key):
        """Join a leaf with its three sisters; False where they are not alike."""
        x, y, side = key
        double = 2 * side
        mother = (
            self.x + (x - self.x) // double * double,
            self.y + (y - self.y) // double * double,
            double,
        )
        counts = [self.leaves.get(child) for child in quarters(mother)]
        if double == self.side or counts[0] is None or counts[0][1] or counts != 4 * counts[:1]:
            return False
        for child in quarters(mother):
            del self.leaves[child]
        self.leaves[mother] = counts[0]
        return True


def quarters(key):
    """The four squares of half the side."""
    half = key[2] // 2
    return [(x, y, half) for x in (key[0], key[0] + half) for y in (key[1], key[1] + half)]


def unmasked(sensor, end):
    """Cells of a ray without its end and the end's eight neighbours (B 4.4.2)."""
    around = {(end[0] + i, end[1] + j) for i in (-1, 0, 1) for j in (-1, 0, 1)}
    return [cell for cell in bresenham(sensor, end) if cell not in around]


def bresenham(start, end):
    """Cells of a ray, by the loop of B 4.4.1."""
    (x0, y0), (x1, y1) = start, end
    steep = abs(y1 - y0) > abs(x1 - x0)
    if steep:
        x0, y0, x1, y1 = y0, x0, y1, x1
    if x1 < x0:
        x0, y0, x1, y1 = x1, y1, x0, y0
    dx, dy, y, found = x1 - x0, abs(y1 - y0), y0, []
    error = -(dx // 2)
    for x in range(x0, x1 + 1):
        found.append((y, x) if steep else (x, y))
        error += dy
        if error > 0:
            y += 1 if y1 > y0 else -1
            error -= dx
    return found


def cell(point, corner, resolution):
    """One division, then the floor."""
    return tuple(math.floor((p - c) / resolution) for p, c in zip(point, corner, strict=True))


def leaves_of(map):
    """Leaves as the literal form keeps them: cells from the first corner -> both counts."""
    found = map.leaves()
    where = np.stack([found.x - map.corner[0], found.y - map.corner[1], found.side], -1)
    cells = np.rint(where / map.resolution).astype(int).tolist()
    assert len({tuple(c) for c in cells}) == len(cells)
    return {tuple(c): [v, o] for c, v, o in zip(cells, found.vis, found.occ, strict=True)}


def state(map):
    """Every bit of a map that later answers depend on."""
    tree = map.tree
    nodes = slice(0, 4 * tree.used)
    counts = tree.vis[nodes].tobytes(), tree.occ[nodes].tobytes(), tree.corner.tobytes()
    return *counts, tree.used, tree.block, tree.level, map.scans
