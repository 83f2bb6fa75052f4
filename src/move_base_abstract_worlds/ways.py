"""Ways and legs of robots that do not drive yet, by the planners and laws by which they will."""
from move_base_abstract.motion.robot import Robot
from move_base_abstract.motion.route import CornerLaw

#: so many ways are asked for by one check at most; beyond, it says that it did not look
MOST_WAYS = 20_000


def leg_between(drivers, begin, goal):
    """Return the leg of a robot of ``drivers`` from ``begin`` to ``goal`` (Pose2D), from rest to rest, or None.

    At full speed, as :meth:`.Robot.depart` makes it: without overhead, factors and traffic.
    """
    corners = None if drivers.planner is None else drivers.planner.corners(begin, goal)
    if corners is None:
        return None
    settings = drivers.settings
    robot = Robot(0, 'robot', begin, settings.limits, settings.tolerances, 0, CornerLaw(settings.values['corners']),
                  settings.phases, 1, settings.original)
    try:
        return robot.depart(goal, 0, corners)
    except ValueError:  # so far away that no number holds it
        return None
