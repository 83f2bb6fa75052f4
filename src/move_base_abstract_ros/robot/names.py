"""The names of one robot's topics, services and parameters, whatever node hosts it."""


class RobotNames:
    """``namespace`` is where the robot's topics live, ``private`` the move_base node's own names; both absolute.

    ``action``: the absolute name of the action, where it is another than move_base in the namespace.
    """

    def __init__(self, namespace, node_name='move_base', action=''):
        self.namespace = '/' + namespace.strip('/')
        self.private = node_name if node_name.startswith('/') else self.topic(node_name)
        self._action = action or self.topic('move_base')

    @property
    def robot(self):
        """The robot's name for people: its namespace without slashes, or the node's."""
        return self.namespace.strip('/') or self.private.strip('/')

    def topic(self, name):
        """Return the absolute name of a topic or service of the robot's namespace."""
        return '{}/{}'.format(self.namespace.rstrip('/'), name)

    def action(self, name):
        """Return the absolute name of a topic of the action, which is not called after the node."""
        return '{}/{}'.format(self._action, name)

    def own(self, name):
        """Return the absolute name of a private topic, service or parameter."""
        return '{}/{}'.format(self.private, name)
