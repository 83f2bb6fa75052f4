"""Add to a launch file what the command line gives: nodes, arguments, parameters, and where robots start."""
import roslaunch.core

from move_base_abstract.common.errors import ConfigurationError

from . import roles
from .start_poses import PLACED


def add_to(config, options):
    """Add to roslaunch's configuration what the options ask for.

    :raises ConfigurationError: if a node to be added exists already, or a node that is named does not exist.
    """
    names = [roles.name_of(node) for node in config.nodes]
    for name, added in options.add.items():
        if name in names:
            raise ConfigurationError('--add {}: the launch file has a node of this name'.format(name))
        config.nodes.append(_node(config, name, *split(added)))
        names.append(name)
    for name, arguments in options.node_args.items():
        check_known('--node-args', name, names)
        for node in config.nodes:
            if roles.name_of(node) == name:
                node.args = arguments
    for key, value in single(options.param):
        put(config, key, value)
    for name, pose in options.start.items():
        check_known('--start', name, names)
        for key, value in zip(PLACED, pose):
            put(config, '{}/{}'.format(name, key), value)


def single(parameters):
    """Yield (full name, value) of each parameter: a mapping sets one for each of its values, and leaves the others."""
    for key, value in parameters.items():
        if isinstance(value, dict) and value:
            yield from single({'{}/{}'.format(key, name): one for name, one in value.items()})
        else:
            yield key, value


def told(options):
    """Return lines for the user: the added nodes, and where robots start."""
    return ['{} is added: {}/{}'.format(name, *split(added)) for name, added in options.add.items()] + [
        '{} starts at ({:g}, {:g}, {:g})'.format(name, *pose) for name, pose in options.start.items()]


def split(added):
    """Return (package, type, arguments) of 'PACKAGE/TYPE [ARGUMENTS]'."""
    kind, _, arguments = added.partition(' ')
    return (*kind.split('/'), arguments)


def check_known(option, name, names):
    """Raise ConfigurationError if the launch file has no node of the name that an option has."""
    if name not in names:
        raise ConfigurationError('{} {}: the launch file has no node of this name; it has {}'.format(
            option, name, ', '.join(names) or 'none'))


def _node(config, name, package, kind, arguments):
    namespace, _, base = name.rpartition('/')
    node = roslaunch.core.Node(package, kind, name=base, namespace=namespace + '/', args=arguments)
    node.machine = config.machines['']
    return node


def put(config, key, value):
    """Set a parameter of the configuration, in the place of what it has of this name, or below it."""
    for name in [name for name in config.params if name.startswith(key + '/')]:
        del config.params[name]
    config.params[key] = roslaunch.core.Param(key, value)
