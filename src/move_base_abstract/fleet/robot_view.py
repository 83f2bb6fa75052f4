"""One robot of a fleet as an object, so that calls need not name the robot."""
from ..goals.activity import activity


class RobotView:
    """A robot of a :class:`Fleet`. Properties are those of the present; it is usable as long as the robot exists.

    :raises ConfigurationError: if there is no robot of that name.
    """

    def __init__(self, fleet, name):
        fleet.pose(name)  # raises an error if there is no robot of that name
        self._fleet = fleet
        self.name = name

    @property
    def pose(self):
        """The robot's pose (Pose2D, m and rad, global frame)."""
        return self._fleet.pose(self.name)

    @property
    def distance(self):
        """The distance that the robot has driven so far [m]."""
        return self._fleet.distance(self.name)

    @property
    def state_of_charge(self):
        """The state of charge of the robot's battery (0..1), or None if it has no battery."""
        battery = self._fleet.condition(self.name).battery
        return None if battery is None else battery.soc

    @property
    def activity(self):
        """What the robot does, in a word or two: travelling, waiting, working, charging, idle, failed, held."""
        member = self._fleet._members[self.name]
        return activity(member.navigator, member.condition, member.tasks)

    def distance_to(self, x, y):
        """Return the straight-line distance [m] from the robot to (x, y) [m]."""
        pose = self.pose
        return ((x - pose.x) ** 2 + (y - pose.y) ** 2) ** 0.5

    def scan(self):
        """Return the scan that the robot's laser measures now (:class:`.laser.Scan`)."""
        return self._fleet.scan(self.name)

    def send(self, x, y, yaw=0.0):
        """Send the robot a goal [m, rad, frame ``map``], see :meth:`Fleet.send`; return the goal's id."""
        return self._fleet.send(self.name, x, y, yaw)

    def cancel(self):
        """Cancel whatever goal the robot has."""
        self._fleet.cancel(self.name)

    def __repr__(self):
        pose = self.pose
        return '<robot {}: {} at ({:.2f}, {:.2f}, {:.2f}) at {:.3f} s>'.format(
            self.name, self.activity, pose.x, pose.y, pose.yaw, self._fleet.now)
