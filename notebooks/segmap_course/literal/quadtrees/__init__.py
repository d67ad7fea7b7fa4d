"""The quadtree of B and its matchers, as plain loops."""
