"""The program ``mapf``. It is not a node; its code is in the package ``move_base_abstract_mapf``."""
from move_base_abstract_mapf.command import main

__all__ = ['main']
