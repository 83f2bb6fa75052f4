"""Find out whether a program uses rospy or roscpp, and so can take part in lockstep."""
import ast
import os
import re
import shutil
import site
import sys
from importlib.machinery import PathFinder

from roslib import packages
from rospkg import ResourceNotFound, RosPack

from ..lockstep.code import older
from ..lockstep.programs import command_line, recorders
from ..lockstep.programs.binary import links_to_roscpp
from ..lockstep.programs.shell_scripts import programs_in

_RELAY = re.compile(rb"^python_script = '([^'\n]+)'", re.MULTILINE)  # in catkin's relay scripts of a devel space
_EXTENDS = re.compile(rb"^__extended_path = ['\"]([^'\"\n]+)['\"]", re.MULTILINE)  # in catkin's packages there
_IMPORT = re.compile(rb'^[ \t]*(?:from|import)[ \t]+([A-Za-z_][\w.]*(?:[ \t]*,[ \t]*[A-Za-z_][\w.]*)*)', re.MULTILINE)
_FROM = re.compile(rb'^[ \t]*from[ \t]+(\.*[A-Za-z_][\w.]*|\.+)[ \t]+import[ \t]+(\([^)]*\)|[^\n;#(]+)', re.MULTILINE)
_LIBRARIES = tuple(os.path.join(folder, '') for folder in (*site.getsitepackages(), '/usr/lib/python3/dist-packages'))
_COMMENT = re.compile(rb'#[^\n]*')
_ROSPY = ('rospy', 'rostopic', 'rosservice', 'actionlib', 'tf', 'tf2_ros')  # rospy, and libraries that import it
_ROS = (*_ROSPY, 'rosgraph', 'roslib', 'genpy', 'genmsg')
# Libraries that are not searched: those of ROS are known, and the others do not import ROS but have hundreds of files.
_CLOSED = (*_ROS, 'numpy', 'scipy', 'matplotlib', 'pandas', 'networkx', 'PIL', 'yaml', 'cv2', 'sklearn', 'torch')
# A publisher of /clock: by the topic's name, or by the type of the message if the name is not in quotes.
_CLOCK = re.compile(rb'\bPublisher\(\s*(?:name\s*=\s*)?(?:["\']/?clock["\']|(?!["\'])[^(),]+,\s*(?:data_class\s*=\s*)?'
                    rb'(?:rosgraph_msgs\.msg\.)?Clock\b)')
_LARGEST = 1 << 20  # bytes of a source that are read
_MOST_FILES = 300
_LONGEST_FIRST_LINE = 200  # bytes


def kind_of(path):
    """Return ('rospy', '') or ('roscpp', ''), or (None, why the program at ``path`` cannot take part)."""
    try:
        kind, path, _ = command_line.find([path])
        if kind == 'binary':
            return ('roscpp', '') if links_to_roscpp(path) else (None, 'it is a binary without roscpp')
    except ValueError as error:
        return None, str(error)
    if kind == 'shell':
        return _kind_of_shell(path)
    return ('rospy', '') if uses_rospy(path) else (None, 'neither it nor its imports import rospy')


def _kind_of_shell(path):
    text = _read(path)
    if recorders.becomes_recorder(text):
        return 'roscpp', ''
    if b'python' in text and any(name.split('.')[0] in _ROSPY for name in _imports(text)):
        return 'rospy', ''  # a file that is both: a script for the shell, and one for the Python that the shell starts
    for found in programs_in(path, text.decode('utf-8', 'replace'), _package, _nodes):
        if command_line.kind_of(found) == 'script' and uses_rospy(found):
            return 'rospy', ''
    return None, 'it is a shell script, and no rospy program can be seen in it (binaries that it starts are not ' \
                 'followed; --participant makes it take part)'


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
    """Return whether a script, or a module that it imports, imports rospy. The files are read, and not run."""
    return any(name.split('.')[0] in _ROSPY for source in _sources(path) for name in _imports(source))


def publishes_clock(path):
    """Return whether a Python script, or a module that it imports, has a publisher of /clock in its text."""
    try:
        kind, path, _ = command_line.find([path])
    except ValueError:
        return False
    return kind == 'script' and any(_CLOCK.search(source) for source in _sources(path) if b'lock' in source)


def mentions(path, word):
    """Return whether ``word`` (bytes) is in a program's own file. Its imports are not searched, to save time."""
    return word in _read(_behind_relay(path))


def imports_one_of(path, modules):
    """Return whether a Python program's own file imports one of the modules, or something below one."""
    return any(name.split('.')[0] in modules for name in _imports(_read(_behind_relay(path))))


def missing_interpreter(path):
    """Return the interpreter that a script names in its first line, if it is not here, or ''."""
    first = _read(path)[:_LONGEST_FIRST_LINE].partition(b'\n')[0].decode('utf-8', 'replace')
    words = re.split('[ \t]+', first[2:].strip(' \t')) if first.startswith('#!') else ['']
    of_env = [word for word in words[1:] if word != '-S'] if os.path.basename(words[0]) == 'env' else []
    name = (of_env or words)[0]
    if name.startswith('-') or '=' in name:  # of `env`: which word names the interpreter depends on the option
        return ''
    return repr(name)[1:-1] if name and shutil.which(name) is None else ''


def wants_python3(path):
    """Return whether a program's first line names Python 3."""
    return b'python3' in _read(_behind_relay(path))[:_LONGEST_FIRST_LINE].partition(b'\n')[0]


def cannot_start(path, is_older=False):
    """Return why a Python script cannot be imported here, or ''. The script is read, and not run.

    ``is_older``: it is written for Python 2.
    """
    try:
        kind, path, _ = command_line.find([path])
        path = _behind_relay(path)
        parse = older.tree_of if is_older and not wants_python3(path) else ast.parse
        tree = parse(_read(path), path) if kind == 'script' else None
    except SyntaxError as error:
        return 'it is not written for this Python ({}, line {}: {})'.format(
            os.path.basename(path), error.lineno, error.msg)
    except ValueError:
        return ''
    folders = [os.path.dirname(os.path.realpath(path)), *sys.path[1:]]
    for node in tree.body if tree else ():
        names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else [
            node.module] if isinstance(node, ast.ImportFrom) and not node.level else []
        for name in names:
            if not _is_importable(name, folders):
                return 'it imports {} (line {}), which is not here'.format(name, node.lineno)
    return ''


def _is_importable(name, folders):
    # The code of a module, not its folder, decides which names are below it (os.path), so its parts end there.
    return name.partition('.')[0] in (*sys.builtin_module_names, '__future__') or None not in _specs(name, folders)


def _sources(path):
    """Yield the text of a script and of the modules that it imports, but not of those in _CLOSED."""
    path = _behind_relay(path)
    folders = [os.path.dirname(os.path.realpath(path)), *sys.path[1:]]
    waiting, seen = [path], {path}
    while waiting and len(seen) < _MOST_FILES:
        path = waiting.pop(0)
        source = _read(path)
        yield source
        for name in (*_imports(source), *(_from(source, path) if _is_of_user(path) else ())):
            for found in _files_of(name, folders) if name.split('.')[0] not in _CLOSED else ():
                if found not in seen:
                    seen.add(found)
                    waiting.append(found)


def different(paths):
    """Return the paths of those programs that are files of their own: no relays to, or links to, others of them."""
    return list({os.path.realpath(_behind_relay(path)): path for path in reversed(paths)}.values())[::-1]


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


def _from(source, path):
    """Yield PACKAGE.NAME for each `from PACKAGE import NAME`, also with dots: NAME may be a module of the package."""
    for found, words in _FROM.findall(source):
        package = found.decode('ascii', 'ignore')
        dots = len(package) - len(package.lstrip('.'))
        around = _around(path)[:-(dots - 1) or None] if dots else []
        for name in _COMMENT.sub(b'', words).decode('ascii', 'ignore').strip('()').split(','):
            parts = [*around, *filter(None, package.lstrip('.').split('.')), *name.split()[:1]]
            if parts:
                yield '.'.join(parts)


def _around(path):
    """Return the names of the packages around a file, the outermost first."""
    names, folder = [], os.path.dirname(path)
    while os.path.isfile(os.path.join(folder, '__init__.py')):
        folder, name = os.path.split(folder)
        names.insert(0, name)
    return names


def _files_of(name, folders):
    """Yield the files of a module and of the packages around it, but not those of Python's own library."""
    for spec in _specs(name, folders):
        if spec is not None and spec.origin and spec.origin.endswith('.py') and not _is_of_python(spec.origin):
            yield spec.origin


def _specs(name, folders):
    """Yield the spec of each package around a module and of the module; None, as the last one, if it is not there."""
    for part in name.split('.'):
        try:
            spec = PathFinder.find_spec(part, folders)
        except (ImportError, ValueError):
            return
        yield spec
        if spec is None or not spec.submodule_search_locations:
            return
        folders = [*spec.submodule_search_locations, *_extended(spec.origin, part)]


def _extended(origin, package):
    """Return the folders of the package according to its file in catkin's devel space."""
    found = _EXTENDS.search(_read(origin)) if origin else None
    return [os.path.join(folder, package) for folder in os.fsdecode(found.group(1)).split(';')] if found else []


def _is_of_user(path):
    """Return whether a file belongs neither to a library installed for this Python nor to messages: these are many."""
    return not path.startswith(_LIBRARIES) and os.path.basename(os.path.dirname(path)) not in ('msg', 'srv')


def _is_of_python(path):
    return path.startswith(os.path.dirname(os.__file__) + os.sep) and '-packages' + os.sep not in path
