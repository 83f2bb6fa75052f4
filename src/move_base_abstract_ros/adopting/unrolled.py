"""Find the nodes that a shell script of a launch file starts in the background: one node cannot stand for them.

This happens with `--list`, too, so the script must not change anything. A restricted bash runs it, which opens no file
for writing and runs no program by its path. By name it has only stand-ins for ROS's commands, which note what is asked
(`rosparam get` answers from the launch file's parameters), and programs that cannot write.
"""
import os
import re
import shlex
import shutil
import signal
import subprocess
import tempfile

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.ros_names import natural_order
from move_base_abstract.lockstep.run_options import ADDED, NODE

_IN_BACKGROUND = re.compile(r'^[^#\n]*\brosrun\s+\S.*&[ \t]*$', re.MULTILINE)
_NAMED = re.compile(r'\binit_node\(\s*["\'](\w+)["\']')
_NAME = '__name:='
_LONGEST = 10.0  # s, wall
_LARGEST = 1 << 20  # bytes of a program
_LARGEST_SCRIPT = 1 << 16  # bytes: it is one argument of a program
_WRITTEN = re.compile(r'(?:\d|&)?>>?\s*(?!&)[^\s&;|)]+')
_REFUSED = re.compile(r'(line \d+: .*): (?:command not found|restricted|readonly variable)')
_MOST_TOLD = 5
#: before the script: `kill` and `history -w` act beyond it; a restricted bash refuses the others, which do no harm.
#: What it starts with `2>&1 &` holds nothing open until whose end somebody waits: so bash itself waits.
_BEFORE = 'enable -n kill history fc; cd() { :; }; source() { :; }; exec() { "$@"; }; trap wait EXIT; '
_READERS = ('basename', 'cat', 'cut', 'dirname', 'expr', 'grep', 'head', 'rospack', 'seq', 'tail', 'tr', 'uname', 'wc')
_RUN = '#!/bin/sh\nprintf "%s\\0" "$ROS_NAMESPACE" "$@" > "${0%/*}/noted/$$"\n'
_SILENT = '#!/bin/sh\nexit 0\n'


def starts_several(path):
    """Return whether a file is a shell script that starts nodes in the background."""
    text = _text_of(path)
    return text.startswith('#!') and 'sh' in text.partition('\n')[0] and _IN_BACKGROUND.search(text) is not None


def _text_of(path):
    """Return the text of a script, or '' if it is none."""
    with open(path, 'rb') as stream:
        text = stream.read(_LARGEST_SCRIPT).decode('utf-8', 'surrogateescape')
    return '' if '\0' in text or os.path.getsize(path) > _LARGEST_SCRIPT else text


def nodes_of(path, words, params, find_node):
    """Return {full name: 'PACKAGE/TYPE ARGUMENTS'} of the nodes that a script starts, and a text: what it was refused.

    ``words``: its arguments; ``params``: {full name: value} of the launch file; ``find_node``: returns the path of the
    program of a package and a type, or None.
    """
    found = {}
    noted, refused = _noted(path, words, params)
    for namespace, *started in noted:
        if len(started) >= 2:
            package, kind, *others = started
            kind = kind.rpartition('/')[2]  # roslaunch finds it by its name
            named = [word[len(_NAME):] for word in others if word.startswith(_NAME)]
            name = named[0] if named else _name_in(find_node(package, kind)) or kind.partition('.')[0]
            name = '/'.join(['', *filter(None, [namespace.strip('/'), name.strip('/')])])
            added = ' '.join([package + '/' + kind, *[
                shlex.quote(word) for word in others if not word.startswith(_NAME)]])
            try:
                found[NODE.check('', name)] = ADDED.check('', added)  # ROS has one of a name
            except ConfigurationError:
                refused.append('start {} as {}'.format(ascii(added), ascii(name)))
    return {name: found[name] for name in sorted(found, key=natural_order)}, '' if not refused else (
        '; while they were looked for, it could not do this: ' + '; '.join(refused))


def _noted(path, words, params):
    with tempfile.TemporaryDirectory(prefix='unrolled_') as folder:
        os.mkdir(os.path.join(folder, 'noted'))
        for name, text in (('rosrun', _RUN), ('rosparam', _answers(params)), *((name, _SILENT) for name in (
                'roslaunch', 'rosservice', 'rostopic', 'rosnode', 'rosbag', 'sleep'))):
            with open(os.path.join(folder, name), 'w', encoding='utf-8') as stream:
                stream.write(text)
            os.chmod(stream.name, 0o755)
        for name in _READERS:
            if shutil.which(name):
                os.symlink(shutil.which(name), os.path.join(folder, name))
        refused = _run_restricted(path, words, folder)
        noted = []
        for name in sorted(os.listdir(os.path.join(folder, 'noted'))):
            with open(os.path.join(folder, 'noted', name), encoding='utf-8', errors='replace') as stream:
                noted.append(tuple(stream.read().split('\0')[:-1]))
        return sorted(filter(None, dict.fromkeys(noted))), refused  # one that was ended before it noted has nothing


def _run_restricted(path, words, folder):
    """Run a script with the programs of a folder alone. Return what it was refused, as texts."""
    text = _IN_BACKGROUND.sub(lambda line: _WRITTEN.sub('', line.group()), _text_of(path))
    environment = {name: value for name, value in os.environ.items() if name != 'BASH_ENV'}
    child = subprocess.Popen(
        ['/bin/bash', '-r', '-c', _BEFORE + text, path, *words], cwd=folder, stdin=subprocess.DEVNULL,
        env={**environment, 'PATH': folder, 'LC_ALL': 'C'}, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
        start_new_session=True)
    late = []
    try:
        errors = child.communicate(timeout=_LONGEST)[1]  # until what it has started has closed it, too
    except subprocess.TimeoutExpired:  # what it waits for is not there; what it has started by then is noted
        late = ['end within {:g} s'.format(_LONGEST)]
        os.killpg(child.pid, signal.SIGKILL)
        errors = child.communicate()[1]
    told = list(dict.fromkeys(_REFUSED.findall(errors.decode('utf-8', 'replace'))))
    return told[:_MOST_TOLD] + ['and more'] * (len(told) > _MOST_TOLD) + late


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
        found = _NAMED.search(stream.read(_LARGEST).decode('utf-8', 'replace'))
    return found.group(1) if found else ''
