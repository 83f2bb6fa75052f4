"""Robots, zones and places as markers for RViz."""
