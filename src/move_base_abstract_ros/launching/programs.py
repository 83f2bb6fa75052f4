"""What kind of program a file is: whether it is a rospy or a roscpp one, and so can take part in lockstep."""
import os
import re
import sys
from importlib.machinery import PathFinder

from roslib import packages
from rospkg import ResourceNotFound, RosPack

from ..lockstep import recorders
from ..lockstep.binary import links_to_roscpp
from ..lockstep.shell_scripts import programs_in
from ..nodes import lockstep_launcher

_RELAY = re.compile(rb"^python_script = '([^'\n]+)'", re.MULTILINE)  # of catkin, in a devel space
_IMPORT = re.compile(rb'^[ \t]*(?:from|import)[ \t]+([A-Za-z_][\w.]*(?:[ \t]*,[ \t]*[A-Za-z_][\w.]*)*)', re.MULTILINE)
_ROSPY = ('rospy', 'rostopic', 'rosservice', 'actionlib', 'tf', 'tf2_ros')  # and those that import it
_ROS = (*_ROSPY, 'rosgraph', 'roslib', 'genpy', 'genmsg')
_CLOCK = re.compile(rb'\bPublisher\(\s*(?:name\s*=\s*)?["\']/?clock["\']')
_LARGEST = 1 << 20  # bytes of a source that are looked at
_MOST_FILES = 300


def kind_of(path):
    """Return 'rospy' or 'roscpp', or None and why the program at ``path`` cannot take part: a pair."""
    try:
        kind, path, _ = lockstep_launcher.find([path])
        if kind == 'binary':
            return ('roscpp', '') if links_to_roscpp(path) else (None, 'it is a binary without roscpp')
    except ValueError as error:
        return None, str(error)
    if kind == 'shell':
        return _kind_of_shell(path)
    return ('rospy', '') if uses_rospy(path) else (None, 'nothing in it, or in what it imports, imports rospy')


def _kind_of_shell(path):
    text = _read(path)
    if recorders.becomes_recorder(text):
        return 'roscpp', ''
    if b'python' in text and any(name.split('.')[0] in _ROSPY for name in _imports(text)):
        return 'rospy', ''  # both at once: to the shell, and to the Python that it has read the file
    for found in programs_in(path, text.decode('utf-8', 'replace'), _package, _nodes):
        if lockstep_launcher.kind_of(found) == 'script' and uses_rospy(found):
            return 'rospy', ''
    return None, 'it is a shell script, and no rospy program is to be seen in it (binaries that one starts are not ' \
                 'followed; --participant has it take part)'


def _package(name):
    try:
        return RosPack().get_path(name)
    except ResourceNotFound:
        return None


def _nodes(package, kind):
    try:
        return packages.find_node(package, kind)
    except ResourceNotFound:
        return []


def uses_rospy(path):
    """Return whether a script, or a module that it imports, imports rospy; found by reading, without running it."""
    return any(name.split('.')[0] in _ROSPY for source in _sources(path) for name in _imports(source))


def publishes_clock(path):
    """Return whether a Python script, or a module that it imports, has a publisher of /clock in its text."""
    try:
        kind, path, _ = lockstep_launcher.find([path])
    except ValueError:
        return False
    return kind == 'script' and any(_CLOCK.search(source) for source in _sources(path) if b'clock' in source)


def _sources(path):
    """Yield the text of a script and of the modules that it imports, but not those of ROS."""
    path = _behind_relay(path)
    folders = [os.path.dirname(os.path.realpath(path)), *sys.path[1:]]
    waiting, seen = [path], {path}
    while waiting and len(seen) < _MOST_FILES:
        source = _read(waiting.pop(0))
        yield source
        for name in _imports(source):
            for found in _files_of(name, folders) if name.split('.')[0] not in _ROS else ():
                if found not in seen:
                    seen.add(found)
                    waiting.append(found)


def _behind_relay(path):
    found = _RELAY.search(_read(path))
    return os.fsdecode(found.group(1)) if found else path


def _read(path):
    try:
        with open(path, 'rb') as stream:
            return stream.read(_LARGEST)
    except OSError:
        return b''


def _imports(source):
    for words in _IMPORT.findall(source):
        for name in words.decode('ascii', 'ignore').split(','):
            yield name.strip()


def _files_of(name, folders):
    """Yield the files of a module and of the packages around it, but not those of Python's own library."""
    for part in name.split('.'):
        try:
            spec = PathFinder.find_spec(part, folders)
        except (ImportError, ValueError):
            return
        if spec is None:
            return
        if spec.origin and spec.origin.endswith('.py') and not _is_of_python(spec.origin):
            yield spec.origin
        if not spec.submodule_search_locations:
            return
        folders = list(spec.submodule_search_locations)


def _is_of_python(path):
    return path.startswith(os.path.dirname(os.__file__) + os.sep) and '-packages' + os.sep not in path
