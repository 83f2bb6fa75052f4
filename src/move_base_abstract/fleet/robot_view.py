"""One robot of a fleet, with methods that need not name it in each call."""
from ..goals.activity import activity


class RobotView:
    """A robot of a :class:`Fleet`, as it is now. It stays usable as long as the robot is there."""

    def __init__(self, fleet, name):
        fleet.pose(name)  # complains where there is none of that name
        self._fleet = fleet
        self.name = name

    @property
    def pose(self):
        """Where it is (Pose2D, m and rad, global frame)."""
        return self._fleet.pose(self.name)

    @property
    def distance(self):
        """How far it has driven [m]."""
        return self._fleet.distance(self.name)

    @property
    def state_of_charge(self):
        """The state of charge of its battery (0..1), or None without one."""
        battery = self._fleet.condition(self.name).battery
        return None if battery is None else battery.soc

    @property
    def activity(self):
        """What it does, in a word or two: travelling, waiting, working, charging, idle, failed, held."""
        member = self._fleet._members[self.name]
        return activity(member.navigator, member.condition, member.tasks)

    def distance_to(self, x, y):
        """Return how far (x, y) [m] is from it, in a straight line [m]."""
        pose = self.pose
        return ((x - pose.x) ** 2 + (y - pose.y) ** 2) ** 0.5

    def scan(self):
        """Return what its laser measures now (:class:`.laser.Scan`)."""
        return self._fleet.scan(self.name)

    def send(self, x, y, yaw=0.0):
        """Send it a goal, as :meth:`Fleet.send`; return the goal's id."""
        return self._fleet.send(self.name, x, y, yaw)

    def cancel(self):
        """Cancel whatever goal it has."""
        self._fleet.cancel(self.name)

    def __repr__(self):
        pose = self.pose
        return '<robot {}: {} at ({:.2f}, {:.2f}, {:.2f}) at {:.3f} s>'.format(
            self.name, self.activity, pose.x, pose.y, pose.yaw, self._fleet.now)
