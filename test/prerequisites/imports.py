"""Which modules of others a program of this package imports, wherever in its files: read from the sources, not run."""
import ast
from functools import lru_cache
from importlib.util import resolve_name
from pathlib import Path

from move_base_abstract.common.lazy_exports import exports_of
from move_base_abstract_ros.nodes.help import scripts

ROOT = Path(__file__).resolve().parents[2]
SRC = ROOT / 'src'
NODES = 'move_base_abstract_ros.nodes'  # start(NAME) of its package runs the module NAME in it
OURS = {path.parent.name for path in SRC.glob('*/__init__.py')}


def of_program(path):
    """Return {(module of ours, module of others that it imports)} of a program, also imports within functions.

    ``path``: its file, or the name of a program of this package.
    """
    if path in scripts():
        return of_modules([f'{NODES}.{scripts()[path]}'])
    text = path.read_text(encoding='utf-8')
    return of_modules([one for one in of_text(text) if one.partition('.')[0] in OURS])


def of_modules(names):
    """Return {(module of ours, module of others that it imports)} of what modules of ours import."""
    seen, waiting, found = set(), [module for name in names for module in _ours(name)], set()
    while waiting:
        module = waiting.pop()
        if module not in seen:
            seen.add(module)
            for other in _of_module(module):
                if other.partition('.')[0] in OURS:
                    waiting.extend(_ours(other))
                else:
                    found.add((module, other))
    return found


def of_text(text, module=''):
    """Return the dotted names that a module's text imports: for ``from a import b`` both ``a`` and ``a.b``."""
    is_package = bool(module) and _file(module).name == '__init__.py'
    names = set()
    waiting = [ast.parse(text)]
    while waiting:
        node = waiting.pop()
        is_for_types = isinstance(node, ast.If) and getattr(node.test, 'id', '') == 'TYPE_CHECKING'
        waiting += node.orelse if is_for_types else ast.iter_child_nodes(node)
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            above = module.split('.')[:-node.level or None] if not is_package else \
                module.split('.')[:1 - node.level or None]
            base = '.'.join([*(above if node.level else []), *([node.module] if node.module else [])])
            names |= {base, *(f'{base}.{alias.name}' for alias in node.names)}
    return names


@lru_cache(maxsize=None)
def _of_module(module):
    return sorted(of_text(_file(module).read_text(encoding='utf-8'), module))


@lru_cache(maxsize=None)
def _file(module):
    """Return the file of a module of ours, or None."""
    path = SRC.joinpath(*module.split('.'))
    files = [file for file in (path / '__init__.py', path.with_suffix('.py')) if file.is_file()]
    return files[0] if files else None


@lru_cache(maxsize=None)
def _ours(name):
    """Return the modules that the import of a name loads: itself, if it is one, its packages, what they hand on."""
    parts = name.split('.')
    found = [module for module in ('.'.join(parts[:count]) for count in range(1, len(parts) + 1)) if _file(module)]
    package, handed = found[-1], name[len(found[-1]) + 1:]
    home = exports_of(_file(package).read_text(encoding='utf-8')).get(handed)
    return [*found, resolve_name(home, package)] if home else found
