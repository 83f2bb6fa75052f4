"""Find the nodes that a shell script of a launch file starts in the background: one node cannot stand for them.

The script is run once with stand-ins for ROS's commands, which only note what is asked: `rosparam get` answers from the
launch file's parameters.
"""
import os
import re
import shlex
import signal
import subprocess
import tempfile
from typing import NamedTuple

_IN_BACKGROUND = re.compile(r'^[^#\n]*\brosrun\s+\S.*&[ \t]*$', re.MULTILINE)
_NODE = re.compile(r'\binit_node\(\s*["\'](\w+)["\']')
_NUMBERS = re.compile(r'(\d+)')
_NAME = '__name:='
_LONGEST = 10.0  # s, wall
_LARGEST = 1 << 20  # bytes
_RUN = '#!/bin/sh\nprintf "%s\\0" "$ROS_NAMESPACE" "$@" > "$(dirname "$0")/noted/$$"\n'
_SILENT = '#!/bin/sh\nexit 0\n'


class Unrolled(NamedTuple):
    """A node that a script starts: its full ``name``, PACKAGE/TYPE, and its arguments as one text."""

    name: str
    program: str
    arguments: str


def starts_several(path):
    """Return whether a file is a shell script that starts nodes in the background."""
    with open(path, 'rb') as stream:
        text = stream.read(_LARGEST).decode('utf-8', 'replace')
    return text.startswith('#!') and 'sh' in text.partition('\n')[0] and _IN_BACKGROUND.search(text) is not None


def nodes_of(path, words, params, find_node):
    """Return the Unrolled nodes that a script starts, in the order of their names.

    ``words``: its arguments; ``params``: {full name: value} of the launch file; ``find_node``: returns the path of the
    program of a package and a type, or None.
    """
    found = []
    for namespace, *started in _noted(path, words, params):
        if len(started) >= 2:
            package, kind, *others = started
            named = [word[len(_NAME):] for word in others if word.startswith(_NAME)]
            name = named[0] if named else _name_in(find_node(package, kind)) or kind.partition('.')[0]
            found.append(Unrolled('/'.join(['', *filter(None, [namespace.strip('/'), name])]), package + '/' + kind,
                                  ' '.join(shlex.quote(word) for word in others if not word.startswith(_NAME))))
    return sorted(found, key=lambda one: [int(part) if part.isdigit() else part for part in _NUMBERS.split(one.name)])


def _noted(path, words, params):
    with tempfile.TemporaryDirectory(prefix='unrolled_') as folder:
        os.mkdir(os.path.join(folder, 'noted'))
        for name, text in (('rosrun', _RUN), ('rosparam', _answers(params)), *((name, _SILENT) for name in (
                'roslaunch', 'rosservice', 'rostopic', 'rosnode', 'rosbag'))):
            with open(os.path.join(folder, name), 'w', encoding='utf-8') as stream:
                stream.write(text)
            os.chmod(stream.name, 0o755)
        environment = {**os.environ, 'PATH': folder + os.pathsep + os.environ.get('PATH', '')}
        child = subprocess.Popen([path, *words], cwd=folder, env=environment, stdin=subprocess.DEVNULL,
                                 stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, start_new_session=True)
        try:
            child.communicate(timeout=_LONGEST)  # until what it has started has closed its output, too
        except subprocess.TimeoutExpired:
            pass  # what it waits for is not there; what it has started by then is noted
        finally:
            try:
                os.killpg(child.pid, signal.SIGKILL)
            except ProcessLookupError:
                pass
            child.wait()
        noted = []
        for name in sorted(os.listdir(os.path.join(folder, 'noted'))):
            with open(os.path.join(folder, 'noted', name), encoding='utf-8', errors='replace') as stream:
                noted.append(stream.read().split('\0')[:-1])
        return noted


def _answers(params):
    """Return a stand-in for rosparam, which knows these parameters."""
    cases = '\n'.join('{}) echo {};;'.format('|'.join(map(shlex.quote, (key, key[1:]))), shlex.quote(_shown(value)))
                      for key, value in params.items())
    return '#!/bin/sh\n[ "$1" = get ] || exit 0\ncase "$2" in\n{}\n*) exit 1;;\nesac\n'.format(cases)


def _shown(value):
    return str(value).lower() if isinstance(value, bool) else str(value)


def _name_in(path):
    if path is None:
        return ''
    with open(path, 'rb') as stream:
        found = _NODE.search(stream.read(_LARGEST).decode('utf-8', 'replace'))
    return found.group(1) if found else ''
