"""The program ``fleet_report``: it is no node, and lives with the experiments."""
from move_base_abstract_experiments.fleet_report import main

__all__ = ['main']
