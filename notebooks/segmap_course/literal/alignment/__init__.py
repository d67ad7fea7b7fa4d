"""Alignment as the papers print it: plain loops."""
