#!/usr/bin/env python3
"""Give each job to the first robot of a set of idle robots, which are plain objects."""
import enum
from abc import ABC, abstractmethod
from dataclasses import dataclass

import rospy
from std_msgs.msg import String


class Kind(enum.Enum):
    SCOUT = 1
    CARRIER = 2


class Agent(ABC):
    @abstractmethod
    def take(self, job):
        pass


class Robot(Agent):
    def __init__(self, number):
        self.name = 'robot_%d' % number
        self.kind = Kind.SCOUT if number % 2 else Kind.CARRIER
        self.padding = 'x' * (number * 37 % 11)  # so that the distances of robots in memory differ

    def take(self, job):
        idle.remove(self)
        busy.append((rospy.get_time() + 1.0 + 0.1 * job, self))
        jobs.publish('%s %d' % (self.name, job))
        given.append(self.name)


@dataclass(frozen=True)
class Place:
    x: float
    y: float


@dataclass(eq=False)
class Dock:
    number: int


class Error(Exception):
    pass


class Odd(Robot, dict):  # derived from a built-in type
    pass


rospy.init_node('dispatcher')
jobs = rospy.Publisher('/jobs', String, queue_size=100)
idle = set()
busy = []
given = []
for number in range(30):
    idle.add(Robot(number))
for job in range(60):
    for end, robot in list(busy):
        if end <= rospy.get_time():
            busy.remove((end, robot))
            idle.add(robot)
    if idle:
        next(iter(idle)).take(job)
    rospy.sleep(0.25)
print(' '.join(given))
print(' '.join(robot.name for robot in idle))
print({Dock(number) for number in range(7)}.pop().number)
print(len({Place(1.0, 2.0), Place(1.0, 2.0)}), Place(1.0, 2.0) == Place(1.0, 2.0))
print(Robot.__mro__[-1] is object, isinstance(Error(), Exception), Odd(3) == {}, sorted(kind.name for kind in {*Kind}))
print(vars(Robot(3)))
