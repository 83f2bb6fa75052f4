"""The program ``scenario``: it is no node, and lives in a package of its own."""
from move_base_abstract_worlds.command import main

__all__ = ['main']
