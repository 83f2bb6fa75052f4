"""The names of one robot's topics, services and parameters, whatever node hosts it."""


class RobotNames:
    """``namespace`` is where the robot's topics live, ``private`` the move_base node's own names; both absolute."""

    def __init__(self, namespace, node_name='move_base'):
        self.namespace = '/' + namespace.strip('/')
        self.private = node_name if node_name.startswith('/') else self.topic(node_name)

    @property
    def robot(self):
        """The robot's name for people: its namespace without slashes, or the node's."""
        return self.namespace.strip('/') or self.private.strip('/')

    def topic(self, name):
        """Return the absolute name of a topic or service of the robot's namespace."""
        return '{}/{}'.format(self.namespace.rstrip('/'), name)

    def action(self, name):
        """Return the absolute name of a topic of the action, which is called move_base whatever the node's name is."""
        return self.topic('move_base/' + name)

    def own(self, name):
        """Return the absolute name of a private topic, service or parameter."""
        return '{}/{}'.format(self.private, name)
