"""segmap: maps of line segments, and quadtree maps, from 2D laser scans."""
