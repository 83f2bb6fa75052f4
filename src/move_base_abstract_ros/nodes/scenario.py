"""The program ``scenario``. It is not a node; its code is in the package ``move_base_abstract_worlds``."""
from move_base_abstract_worlds.command import main

__all__ = ['main']
