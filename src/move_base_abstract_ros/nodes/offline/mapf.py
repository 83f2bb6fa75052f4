"""The program ``mapf``: it is no node, and lives in a package of its own."""
from move_base_abstract_mapf.command import main

__all__ = ['main']
