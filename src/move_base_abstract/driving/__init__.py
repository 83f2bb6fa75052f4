"""Robots that are driven by velocities: commands, limits, the watchdog; the arcs that follow, and what stops them."""
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .contact import Shape as Shape, disc as disc, polygon as polygon
    from .contacts import Body as Body, Contacts as Contacts
    from .drive_motion import DriveMotion as DriveMotion, Twist as Twist
    from .driver import Driver as Driver
    from .settings import DriveSettings as DriveSettings, read_drive as read_drive
    from .walls import Walls as Walls
else:
    from ..common.lazy_exports import lazy_exports

    __getattr__ = lazy_exports(__name__)
