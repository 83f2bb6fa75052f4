"""The program ``replay``. It is not a node; its code is in the package ``move_base_abstract_replay``."""
from move_base_abstract_replay.command import main

__all__ = ['main']
