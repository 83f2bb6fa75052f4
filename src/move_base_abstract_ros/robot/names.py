"""The names of one robot's topics, services and parameters, which do not depend on the node that hosts it."""
from __future__ import annotations


class RobotNames:
    """The names of one robot, all of them absolute.

    ``namespace``: that of the robot's topics. ``node_name``: the name of its move_base node, below which its private
    names are. ``action``: the absolute name of the action, if it is not move_base in the namespace.
    """

    def __init__(self, namespace: str, node_name: str = 'move_base', action: str = '') -> None:
        self.namespace = '/' + namespace.strip('/')
        self.private = node_name if node_name.startswith('/') else self.topic(node_name)
        self._action = action or self.topic('move_base')

    @property
    def robot(self) -> str:
        """The robot's name in messages: its namespace without outer slashes, or if that is empty the node's name."""
        return self.namespace.strip('/') or self.private.strip('/')

    def topic(self, name: str) -> str:
        """Return the absolute name of a topic or service in the robot's namespace."""
        return '{}/{}'.format(self.namespace.rstrip('/'), name)

    def action(self, name: str) -> str:
        """Return the absolute name of a topic of the action. It does not depend on the node's name."""
        return '{}/{}'.format(self._action, name)

    def own(self, name: str) -> str:
        """Return the absolute name of a private topic, service or parameter."""
        return '{}/{}'.format(self.private, name)
