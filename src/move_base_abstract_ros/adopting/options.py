"""Options of lockstep_launch and verify that adapt a launch file of others."""
import argparse
import math

from move_base_abstract.common.shown import shown


def add_arguments(parser):
    """Add these options to the parser of a command line."""
    parser.add_argument('--adopt', action='store_true',
                        help='adapt a launch file of others by rule, and print what was done as a command line '
                        '(docs/adopt.md)')
    parser.add_argument('--tolerant', action='store_true',
                        help='leave out what the file names and is not installed; run the nodes of all its machines '
                        'here')
    parser.add_argument('--start', action='append', default=[], type=_start, metavar='NODE=X,Y,YAW',
                        help='set where this robot starts [m, m, rad, map frame]')
    parser.add_argument('--param', action='append', default=[], type=_parameter, metavar='NAME=VALUE',
                        help="set a parameter; it takes precedence over the file's")
    parser.add_argument('--add', action='append', default=[], type=_added, metavar="'NODE=PACKAGE/TYPE [ARGUMENTS]'",
                        help='start this node too')
    parser.add_argument('--args', action='append', default=[], type=_arguments, metavar="'NODE=ARGUMENTS'",
                        help="give this node other arguments than the file's")


def words_of(options):
    """Return the words of a command line for the parsed options."""
    words = [option for option, is_given in (('--adopt', options.adopt), ('--tolerant', options.tolerant)) if is_given]
    return words + words_for(options.add, options.args, options.param, options.start)


def words_for(added, arguments, parameters, starts):
    """Return the words of a command line for these fields of a plan's wishes: added, arguments, set, starts."""
    words = []
    for name, kind, given in added:
        words += ['--add', '{}={}{}'.format(name, '/'.join(kind), ' ' + given if given else '')]
    for option, pairs in (('--args', arguments), ('--param', parameters)):
        words += [word for pair in pairs for word in (option, '='.join(pair))]
    for name, pose in starts:
        words += ['--start', '{}={}'.format(name, ','.join(repr(float(value)) for value in pose))]
    return words


def wishes_of(options):
    """Return {field: value} of the parsed options, for a plan's LaunchOptions."""
    return {'is_tolerant': options.tolerant, 'added': tuple(options.add), 'arguments': tuple(options.args),
            'set': tuple(options.param), 'starts': tuple(options.start)}


def _pair(text, what):
    name, equals, value = text.partition('=')
    if not equals or not name.strip('/'):
        raise argparse.ArgumentTypeError('must be {}, got {}'.format(what, shown(text)))
    return '/' + name.strip('/'), value


def _parameter(text):
    return _pair(text, 'NAME=VALUE')


def _arguments(text):
    return _pair(text, 'NODE=ARGUMENTS')


def _start(text):
    name, value = _pair(text, 'NODE=X,Y,YAW')
    try:
        pose = tuple(float(word) for word in value.split(','))
    except ValueError:
        pose = ()
    if len(pose) != 3 or not all(map(math.isfinite, pose)):
        raise argparse.ArgumentTypeError('must be NODE=X,Y,YAW [m, m, rad], got {}'.format(shown(text)))
    return name, pose


def _added(text):
    name, value = _pair(text, 'NODE=PACKAGE/TYPE [ARGUMENTS]')
    kind, _, arguments = value.partition(' ')
    if kind.count('/') != 1:
        raise argparse.ArgumentTypeError('must be NODE=PACKAGE/TYPE [ARGUMENTS], got {}'.format(shown(text)))
    return name, tuple(kind.split('/')), arguments.strip()
