"""The yardsticks of the quadtree: the same map in plain Python lists, and a dense grid in numpy.

The twin counts what `QuadtreeMap` counts, leaf for leaf; the grid counts cell by cell.
"""

from math import floor

import numpy as np


class PlainTree:
    """The quadtree with lists and ints, walked leaf by leaf; large enough from the start."""

    def __init__(self, cell, level):
        self.cell, self.level = cell, level
        self.vis, self.occ = [0] * 4, [0] * 4
        self.path, self.known, self.x, self.y = [0] * (level + 1), level, 0, 0

    def insert(self, sensor, points):
        side, middle = self.cell, 1 << (self.level - 1)
        sx, sy = (floor(v / side) + middle for v in sensor.tolist())
        ends = [(floor(x / side) + middle, floor(y / side) + middle) for x, y in points.tolist()]
        for x, y in ends:
            self.split(x, y)
        for x, y in ends:
            node, _ = self.leaf(x, y)
            if self.occ[node]:
                self.vis[node] += 1
            self.occ[node] += 1
        for x, y in ends:
            self.walk(sx, sy, x, y)

    def leaf(self, x, y):
        """Node and level, from the smallest square that holds this cell and the last."""
        vis, path = self.vis, self.path
        level = max(((x ^ self.x) | (y ^ self.y)).bit_length(), self.known)
        self.x, self.y = x, y
        block = path[level]
        while True:
            level -= 1
            node = 4 * block + (x >> level & 1) + 2 * (y >> level & 1)
            if vis[node] >= 0:
                self.known = level + 1
                return node, level
            path[level] = block = ~vis[node]

    def split(self, x, y):
        node, level = self.leaf(x, y)
        while level:
            block = len(self.vis) // 4
            self.vis[node], self.occ[node] = ~block, 0
            self.vis += [1] * 4
            self.occ += [0] * 4
            self.path[level] = block
            level -= 1
            node = 4 * block + (x >> level & 1) + 2 * (y >> level & 1)
        self.known = 1

    def walk(self, sx, sy, ex, ey):
        vis, leaf = self.vis, self.leaf
        dx, dy = ex - sx, ey - sy
        steep = abs(dy) > abs(dx)
        long, short = (abs(dy), abs(dx)) if steep else (abs(dx), abs(dy))
        half = (long - 1) // 2
        rest = half if (dy if steep else dx) > 0 else long - 1 - half
        step, across, last = 0, 0, long - 2
        while step <= last:
            along_x, along_y = (across, step) if steep else (step, across)
            x = sx + along_x if dx >= 0 else sx - along_x
            y = sy + along_y if dy >= 0 else sy - along_y
            node, level = leaf(x, y)
            vis[node] += 1
            mask = (1 << level) - 1
            to_x = mask + 1 - (x & mask) if dx >= 0 else (x & mask) + 1
            to_y = mask + 1 - (y & mask) if dy >= 0 else (y & mask) + 1
            along, aside = (to_y, to_x) if steep else (to_x, to_y)
            reach = (step + along) * short + rest
            if reach < (across + aside) * long:
                step, across = step + along, reach // long
            else:
                across += aside
                step = (across * long - rest + short - 1) // short


class DenseGrid:
    """Two counters of four bytes a cell; all rays of a scan at once in numpy."""

    def __init__(self, bounds, cell):
        self.corner, self.cell = np.array(bounds[:2]), cell
        rows, columns = np.ceil((np.array(bounds[2:]) - self.corner) / cell).astype(int)[::-1]
        self.strides = np.array([1, columns])
        self.vis, self.occ = np.zeros(rows * columns, np.int32), np.zeros(rows * columns, np.int32)

    @property
    def nbytes(self):
        return self.vis.nbytes + self.occ.nbytes

    def insert(self, sensor, points):
        start = ((sensor - self.corner) / self.cell).astype(np.int64)
        away = ((points - self.corner) / self.cell).astype(np.int64) - start
        first = start @ self.strides
        np.add.at(self.occ, first + away @ self.strides, 1)
        np.add.at(self.vis, first + away @ self.strides, 1)
        steep = abs(away[:, 1]) > abs(away[:, 0])
        long, short = np.where(steep, away.T[::-1], away.T)
        ahead, aside = (np.sign(v) * np.where(steep ^ i, *self.strides[::-1]) for i, v in
                        enumerate((long, short)))  # fmt: skip
        steps = np.maximum(abs(long) - 1, 0)
        k = np.arange(steps.sum(), dtype=np.int32)
        k -= np.repeat((np.cumsum(steps) - steps).astype(np.int32), steps)
        slope = (abs(short) / np.maximum(abs(long), 1)).astype(np.float32)
        across = (np.repeat(slope, steps) * k + np.float32(0.5)).astype(np.int32)
        cell = k * np.repeat(ahead.astype(np.int32), steps)
        cell += across * np.repeat(aside.astype(np.int32), steps)
        self.vis += np.bincount(cell + first, minlength=len(self.vis)).astype(np.int32)
