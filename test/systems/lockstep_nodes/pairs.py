#!/usr/bin/python3
"""Sends two robots to places at the same distance, again and again; the robot that arrives first draws first.

Parameters: ~goals (in all), ~delay (the longest random pause in a callback [wall s]), ~seed.
"""
import random
import time

import rospy

from move_base_abstract_ros import lockstep
from move_base_abstract_ros.goal_client import GoalClient


class Pairs:
    """Sends each robot in a new direction, drawn from one generator in the order of the arrivals."""

    def __init__(self):
        self._random = random.Random(rospy.get_param('~seed'))
        self._left = rospy.get_param('~goals')
        self._delay = rospy.get_param('~delay')
        self._places = {}
        self.open = 0
        self.clients = [GoalClient('robot_{}'.format(i), self._on_end) for i in range(2)]

    def send(self, client):
        """Send a robot to a place 10 m away."""
        self._left -= 1
        self.open += 1
        x, y = self._places.get(client.name, (0.0, 0.0))
        east, north = self._random.choice(((10.0, 0.0), (-10.0, 0.0), (0.0, 10.0), (0.0, -10.0)))
        self._places[client.name] = x + east, y + north
        client.send(*self._places[client.name])

    def _on_end(self, client, _goal_id, _status, _text):
        if self._delay:
            time.sleep(random.SystemRandom().uniform(0.0, self._delay))
        self.open -= 1
        if self._left > 0:
            self.send(client)


def main():
    """Run until all goals have ended."""
    rospy.init_node('coordinator')
    participant = lockstep.join()
    pairs = Pairs()
    participant.wait_until(lambda: all(client.is_connected() for client in pairs.clients), what='the robots')
    for client in pairs.clients:
        pairs.send(client)
    participant.wait_until(lambda: not pairs.open, what='the goals')


if __name__ == '__main__':
    main()
