"""The program ``calibrate``. It is not a node; its code is in the package ``move_base_abstract_calibration``."""
from move_base_abstract_calibration.command import main

__all__ = ['main']
