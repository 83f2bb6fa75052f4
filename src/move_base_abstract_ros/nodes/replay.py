"""The program ``replay``: it is no node, and lives in a room of its own."""
from move_base_abstract_replay.command import main

__all__ = ['main']
