"""The markers of a robot for RViz: an arrow, its name, its goal and its leg, all in one colour."""
from __future__ import annotations

import colorsys
import re
from dataclasses import dataclass
from typing import Any, List, Optional, Tuple

from geometry_msgs.msg import Point
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker

from move_base_abstract.motion.geometry import Pose2D

from ..messages import conversions

ARROW, NAME, GOAL, LEG = range(4)

_GOLDEN_RATIO = 0.618033988749895
_SATURATION, _VALUE = 0.95, 0.75
# heights [m]; seen from above, the more important markers lie on top
_LEG_Z, _GOAL_Z, _ARROW_Z, _NAME_Z = 0.02, 0.04, 0.06, 0.2


@dataclass(frozen=True)
class Look:
    """What does not change: the robot's name, its number (for its colour), the frame, and the arrow's length [m]."""

    name: str
    number: int
    frame_id: str
    size: float


@dataclass(frozen=True)
class View:
    """What changes: the robot's pose, its goal or None, and its leg (start, corners, end) or None, in the global frame.

    ``state`` is a line of text about what it does; ``is_changing`` says that this text may change soon.
    """

    pose: Pose2D
    goal: Optional[Pose2D] = None
    leg: Optional[Tuple[Pose2D, ...]] = None
    state: str = ''
    is_changing: bool = False

    @property
    def route(self) -> Any:
        """The parts that need not be drawn again while the robot moves: (goal, leg)."""
        return self.goal, self.leg


def robot_number(name: str, index: int) -> int:
    """Return the number at the end of ``name``, or ``index`` without one.

    So robots of several processes have different colours, too.
    """
    digits = re.search(r'(\d{1,9})$', name)
    return int(digits.group(1)) if digits else index


def colour(number: int, alpha: float = 1.0) -> Any:
    """Return the colour (ColorRGBA) of robot ``number``. Successive hues differ much, by a golden section."""
    red, green, blue = colorsys.hsv_to_rgb((number * _GOLDEN_RATIO) % 1.0, _SATURATION, _VALUE)
    return ColorRGBA(red, green, blue, alpha)


def body(look: Look, view: View) -> List[Any]:
    """Return the markers that follow the robot: the arrow, and the name with the text of its state."""
    nose, size = view.pose, look.size
    arrow = _marker(look, ARROW, Marker.ARROW, nose.compose(Pose2D(-size / 2.0)), _ARROW_Z, 1.0)
    arrow.scale.x, arrow.scale.y, arrow.scale.z = size, 0.45 * size, 0.2 * size
    name = _marker(look, NAME, Marker.TEXT_VIEW_FACING, Pose2D(
        nose.x + 0.9 * size, nose.y + (1.3 if view.state else 0.9) * size), _NAME_Z, 1.0)
    name.scale.z = 0.7 * size
    name.text = look.name + ('\n' + view.state if view.state else '')
    return [arrow, name]


def route(look: Look, view: View) -> List[Any]:
    """Return the markers of the goal and the leg, or those that delete them."""
    return [_goal(look, view.goal) if view.goal else _deletion(look, GOAL),
            _leg(look, view.leg) if view.leg else _deletion(look, LEG)]


def farewell(look: Look) -> List[Any]:
    """Return the markers that delete all markers of the robot."""
    return [_deletion(look, marker_id) for marker_id in (ARROW, NAME, GOAL, LEG)]


def _goal(look: Look, goal: Pose2D) -> Any:
    disc = _marker(look, GOAL, Marker.CYLINDER, goal, _GOAL_Z, 0.6)
    disc.scale.x = disc.scale.y = 0.8 * look.size
    disc.scale.z = 0.01
    return disc


def _leg(look: Look, places: Any) -> Any:
    line = _marker(look, LEG, Marker.LINE_STRIP, Pose2D(), 0.0, 0.8)
    line.scale.x = 0.12 * look.size
    line.points = [Point(place.x, place.y, _LEG_Z) for place in places]
    return line


def _marker(look: Look, marker_id: int, kind: int, pose: Pose2D, height: float, alpha: float) -> Any:
    """Return a marker without a stamp, which RViz shows at once, whatever time it is."""
    marker = Marker(ns=look.name, id=marker_id, type=kind, action=Marker.ADD, color=colour(look.number, alpha))
    marker.header.frame_id = look.frame_id
    marker.pose = conversions.to_pose(pose)
    marker.pose.position.z = height
    return marker


def _deletion(look: Look, marker_id: int) -> Any:
    marker = Marker(ns=look.name, id=marker_id, action=Marker.DELETE)
    marker.header.frame_id = look.frame_id
    return marker
