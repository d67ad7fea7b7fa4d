"""Logs and maps of MRPT."""
