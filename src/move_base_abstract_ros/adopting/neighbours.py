"""Find packages that lie beside a launch file, in a checkout that was not built or sourced."""
import os
from xml.etree import ElementTree

import rospkg

_LEVELS = 3  # above the file's own package
_DEPTH = 5
_MOST_FOLDERS = 3000
_NOT_ABOVE = ('/', '/home', '/opt', '/tmp', '/usr', '/var', '/root', os.path.expanduser('~'))


def find(name, path):
    """Return the folder of the package ``name``, if it lies beside the launch file at ``path``, or None.

    The folders around the file are searched, the nearest first: its own package, then up to three folders above that,
    but none above the repository.
    """
    for folder in _around(os.path.dirname(os.path.abspath(path))):
        found = packages_below(folder).get(name)
        if found is not None:
            return found
    return None


def elsewhere(path):
    """Return where a file lies that its author names by a path of his own (/home/.../PACKAGE/FILE), or the path."""
    parts = path.split(os.sep)
    for at in range(len(parts) - 2, 0, -1) if os.path.isabs(path) and not os.path.exists(path) else ():
        try:
            found = os.path.join(rospkg.RosPack().get_path(parts[at]), *parts[at + 1:])
        except rospkg.ResourceNotFound:
            continue
        if os.path.isfile(found):
            return found
    return path


def own_package(path):
    """Return the folder of the package that a file belongs to, or None."""
    folder = os.path.dirname(os.path.abspath(path))
    while not os.path.isfile(os.path.join(folder, 'package.xml')):
        if folder == os.path.dirname(folder):
            return None
        folder = os.path.dirname(folder)
    return folder


def _around(folder):
    """Yield the folders below which a package may lie, the nearest first."""
    while not os.path.isfile(os.path.join(folder, 'package.xml')):
        above = os.path.dirname(folder)
        if above in _NOT_ABOVE or os.path.isdir(os.path.join(folder, '.git')):
            yield folder  # the file is in no package: search below the last folder that may belong to the user
            return
        folder = above
    for _level in range(1 + _LEVELS):
        yield folder
        if os.path.exists(os.path.join(folder, '.git')) or os.path.dirname(folder) in _NOT_ABOVE:
            return
        folder = os.path.dirname(folder)


def packages_below(folder):
    """Return {name: folder} of the packages in a folder and below it."""
    found, waiting = {}, [(folder, 0)]
    for _count in range(_MOST_FOLDERS):
        if not waiting:
            break
        here, depth = waiting.pop(0)
        name = _name_of(os.path.join(here, 'package.xml'))
        if name is not None:
            found.setdefault(name, here)
        elif depth < _DEPTH:
            waiting += [(one, depth + 1) for one in _folders_in(here)]
    return found


def _folders_in(folder):
    try:
        with os.scandir(folder) as entries:
            return sorted(one.path for one in entries if one.is_dir(follow_symlinks=False)
                          and not one.name.startswith('.'))
    except OSError:
        return []


def _name_of(path):
    """Return the package's name in its package.xml; None if there is no such file, '' if it is not valid XML."""
    if not os.path.isfile(path):  # a pipe would never end
        return None
    try:
        return (ElementTree.parse(path).findtext('name') or '').strip()
    except OSError:
        return None
    except ElementTree.ParseError:
        return ''
