"""Robots that are driven by velocities: what they touch, and when."""
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .contact import Shape as Shape, disc as disc, polygon as polygon
    from .contacts import Body as Body, Contacts as Contacts
    from .walls import Walls as Walls
else:
    from ..common.lazy_exports import lazy_exports

    __getattr__ = lazy_exports(__name__)
