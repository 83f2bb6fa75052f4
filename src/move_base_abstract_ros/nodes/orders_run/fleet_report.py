"""The program ``fleet_report``. It is not a node; its code is in the package ``move_base_abstract_experiments``."""
from move_base_abstract_experiments.fleet_report import main

__all__ = ['main']
