"""The program ``calibrate``: it is no node, and lives in a room of its own."""
from move_base_abstract_calibration.command import main

__all__ = ['main']
