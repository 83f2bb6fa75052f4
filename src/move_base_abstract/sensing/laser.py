"""One robot's laser scanner: its parameters, its beams, and a scan at an instant."""
from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Dict, NamedTuple, Sequence

from ..common.kinds import FRAME, TOPIC, error, integer, number
from ..common.parameter_table import Parameter, place_of
from ..motion.geometry import Pose2D

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ..maps.occupancy import OccupancyMap
    from .rays import Body

_MOST_BEAMS = 10_000
_FARTHEST = 1e6  # m
_ON_ROBOT = number(-1000.0, 1000.0, unit='m, base frame')
_ANGLES = number(-6.3, 6.3, unit='rad, laser frame')

TABLE = (
    Parameter('scan_rate', 0.0, number(0.0, 1000.0, unit='Hz, simulated', note='0 = none'), 'Rate of the scans.'),
    Parameter('scan_beams', 361, integer(1, _MOST_BEAMS), 'Number of beams, at equal angles.'),
    Parameter('scan_angle_min', -math.pi, _ANGLES, 'Direction of the first beam.'),
    Parameter('scan_angle_max', math.pi, _ANGLES, 'Direction of the last beam.'),
    Parameter('scan_range_min', 0.05, number(0.0, _FARTHEST, unit='m'), 'Ranges below this are -inf (REP 117).'),
    Parameter('scan_range_max', 10.0, number(0.0, _FARTHEST, unit='m'), 'Ranges above this are inf (REP 117).'),
    Parameter('scan_noise', 0.0, number(0.0, 10.0, note='the standard deviation [m]'),
              'Standard deviation of each range.'),
    Parameter('scan_frame', 'base_laser_link', FRAME, "Frame of the scan; it gets the robot's `tf_prefix`."),
    Parameter('scan_topic', 'scan', TOPIC, "Topic of the scan, in the robot's namespace."),
    Parameter('scan_x', 0.0, _ON_ROBOT, 'Position of the laser on the robot.'),
    Parameter('scan_y', 0.0, _ON_ROBOT, 'Position of the laser on the robot.'),
    Parameter('scan_z', 0.0, _ON_ROBOT, 'Height of the laser on the robot. Only tf has it.'),
    Parameter('scan_yaw', 0.0, number(unit='rad, base frame'), 'Heading of the laser on the robot.'),
)


@dataclass(frozen=True)
class LaserSettings:
    """A laser scanner; ``rate`` [Hz, simulated], 0 = it publishes nothing by itself.

    ``angle_min`` and ``angle_max`` [rad] are the directions of the first and the last beam; ranges are in m.
    ``noise``: the standard deviation of a range [m]; ``mount``: the pose of the laser in the robot's base frame,
    ``height``: its height above it [m], which only tf has.
    """

    rate: float = 0.0
    beams: int = 361
    angle_min: float = -math.pi
    angle_max: float = math.pi
    range_min: float = 0.05
    range_max: float = 10.0
    noise: float = 0.0
    mount: Pose2D = Pose2D()
    height: float = 0.0

    @property
    def angle_increment(self) -> float:
        """The angle between two beams [rad]; 0 if there is only one."""
        return (self.angle_max - self.angle_min) / (self.beams - 1) if self.beams > 1 else 0.0


def read_laser(values: Dict[str, Any], where: str) -> LaserSettings:
    """Return the :class:`LaserSettings` in ``values`` (of :data:`TABLE`).

    :raises ConfigurationError: if an angle or a range ends before it begins; ``where`` is the parameters' namespace.
    """
    for what, unit in (('angle', 'rad'), ('range', 'm')):
        low, high = values['scan_{}_min'.format(what)], values['scan_{}_max'.format(what)]
        if low > high or low == high and (what == 'range' or values['scan_beams'] > 1):  # one beam has one angle
            raise error(place_of(where, f'scan_{what}_min'), low, f'less than that [{unit}]',
                        f' with scan_{what}_max: {high:g}')
    return LaserSettings(values['scan_rate'], values['scan_beams'], values['scan_angle_min'], values['scan_angle_max'],
                         values['scan_range_min'], values['scan_range_max'], values['scan_noise'],
                         Pose2D(values['scan_x'], values['scan_y'], values['scan_yaw']), values['scan_z'])


class Scan(NamedTuple):
    """A scan at ``stamp_ns`` [ns]; ``ranges`` [m] is a float32 array, from the first beam to the last.

    As in REP 117, inf stands for a beam that ends nowhere within ``range_max``, and -inf for one that ends nearer than
    ``range_min``. ``pose`` (Pose2D): the pose of the laser in the global frame; ``settings``: its LaserSettings.
    """

    stamp_ns: int
    pose: Pose2D
    settings: LaserSettings
    ranges: NDArray[Any]


class Laser:
    """The laser of the robot ``robot_name`` in a run with ``seed``. It needs numpy."""

    def __init__(self, settings: LaserSettings, seed: int = 0, robot_name: str = '') -> None:
        import numpy as np  # imported here, since only robots with a laser need it
        self.settings = settings
        angles = [settings.angle_min + number * settings.angle_increment for number in range(settings.beams)]
        # The functions of the C library: their results do not depend on the processor's vector units, as numpy's may.
        self._cos, self._sin = (np.array([function(angle) for angle in angles]) for function in (math.cos, math.sin))
        self._noise = None
        if settings.noise > 0.0:
            from ..engine.chance import Chance
            self._noise = Chance(seed, robot_name)

    def scan(self, base: Pose2D, occupancy: OccupancyMap | None,
             bodies: Sequence[Body], stamp_ns: int) -> Scan:
        """Return the :class:`Scan` of a robot at ``base`` (Pose2D, global frame) at ``stamp_ns`` [ns].

        ``occupancy`` is the map in the global frame, None: there is none; ``bodies``: the outlines of other robots.
        """
        import numpy as np

        from . import rays
        settings = self.settings
        pose = base.compose(settings.mount)
        cos, sin = math.cos(pose.yaw), math.sin(pose.yaw)
        dx, dy = cos * self._cos - sin * self._sin, sin * self._cos + cos * self._sin
        found = np.full(settings.beams, math.inf)
        if occupancy is not None:
            found = rays.of_map(occupancy, pose.x, pose.y, dx, dy, settings.range_max)
        for body in bodies:
            rays.shorten(found, pose.x, pose.y, dx, dy, body)
        found[found > settings.range_max] = math.inf
        if self._noise is not None:
            found += settings.noise * rays.normals(self._noise, settings.beams, stamp_ns)
            found[found > settings.range_max] = math.inf
        found[found < settings.range_min] = -math.inf
        return Scan(stamp_ns, pose, settings, found.astype(np.float32))
