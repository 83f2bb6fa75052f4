"""Read what the environment hooks of a package would set if the package were installed and sourced."""
import glob
import os
import re

from . import neighbours

_FIND = re.compile(r'(?:`|\$\()\s*rospack\s+find\s+([\w.-]+)\s*(?:`|\))|@\(CMAKE_CURRENT_SOURCE_DIR\)')
_LARGEST = 1 << 16  # bytes


def value_of(name, path):
    """Return the value that the hooks of a launch file's package set the variable ``name`` to, or None.

    ``path``: that of the launch file.
    """
    folder = neighbours.own_package(path)
    for hook in sorted(glob.glob(os.path.join(glob.escape(folder), 'env-hooks', '*.sh*'))) if folder else ():
        with open(hook, encoding='utf-8', errors='replace') as stream:
            text = stream.read(_LARGEST)
        found = re.search(r'\$\{%s:=([^}\n]*)\}|^\s*export\s+%s=(\S+)' % (name, name), text, re.MULTILINE)
        if found:
            value = _FIND.sub(lambda one: folder if one.group(1) is None else neighbours.find(
                one.group(1), path) or one.group(), found.group(1) or found.group(2)).strip('\'"')
            return None if '$' in value or '@' in value or '`' in value else value
    return None
