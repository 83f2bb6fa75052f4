"""Reference pages from the sources: public Python names from the lists of the packages, messages from their files."""
import ast
import importlib
from importlib.util import resolve_name
from pathlib import Path

from move_base_abstract.common.lazy_exports import exports_of

ROOT = Path(__file__).resolve().parents[2]
CORE = 'move_base_abstract'
#: other modules that users' nodes and tests import, {module: its names; empty: all of them}
FOR_NODES = {'move_base_abstract_ros.lockstep': ('join', 'is_lockstep', 'participant', 'Participant'),
             'move_base_abstract_ros.goal_client': (), 'move_base_abstract_ros.time_master_client': (),
             'move_base_abstract_testing.system_under_test': ()}
INTERFACES = (('msg', 'Messages'), ('srv', 'Services'), ('action', 'Actions'))



def interfaces():
    """Return the page of all messages, services and actions, from their files."""
    lines = ['# Messages, services, actions', '', 'The files of this package, with units and frames.', '']
    for folder, title in INTERFACES:
        lines += ['## ' + title, '']
        for path in sorted((ROOT / folder).glob('*.' + folder)):
            lines += ['### ' + path.stem, '', '```', path.read_text(encoding='utf-8').rstrip(), '```', '']
    return '\n'.join(lines)


def python():
    """Return the page of the public Python names, package by package."""
    lines = ['# Python', '',
             'Public names, with their docstrings. What each package is for: [architecture](architecture.md).', '',
             '## Without ROS', '', 'Robots in plain Python, and the core of the nodes.', '']
    shown = set()
    for room, names in _rooms(CORE):
        if room:
            lines += ['### {}.{}'.format(CORE, room), '', importlib.import_module(CORE + '.' + room).__doc__ or '', '']
        for name, home in names:
            if (home, name) not in shown:
                shown.add((home, name))
                lines += _entry(_kind(home, name), '.'.join(part for part in (CORE, room, name) if part))
    lines += ['## For nodes and tests', '']
    for module, names in FOR_NODES.items():
        lines += ['### ' + module, '']
        lines += [] if names else _entry('automodule', module)
        for name in names:
            lines += _entry('autoclass' if name[0].isupper() else 'autofunction', module + '.' + name)
    return '\n'.join(lines)


def _entry(kind, name):
    options = '\n    :members:' if kind in ('autoclass', 'automodule') else ''
    return ['```{eval-rst}', '.. {}:: {}{}'.format(kind, name, options), '```', '']


def _text_of(home):
    """Return (the text of a module's source, the package in which it lies or that it is)."""
    path = (ROOT / 'src').joinpath(*home.split('.'))
    if path.is_dir():
        return (path / '__init__.py').read_text(encoding='utf-8'), home
    return path.with_suffix('.py').read_text(encoding='utf-8'), home.rpartition('.')[0]


def _home(home, name):
    """Return the module that makes a name: ``home``, or the one from which that has it."""
    text, package = _text_of(home)
    imports = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.ImportFrom)
               and name in [alias.name for alias in node.names]]
    if not imports:
        return home
    return _home(resolve_name('.' * imports[0].level + (imports[0].module or ''), package), name)


def _kind(home, name):
    """Return Sphinx's directive for a name of a module, from its source, as not all modules can be imported."""
    found = {getattr(node, 'name', ''): node for node in ast.parse(_text_of(home)[0]).body}.get(name)
    return {ast.ClassDef: 'autoclass', ast.FunctionDef: 'autofunction'}.get(type(found), 'autodata')


def _rooms(package):
    """Yield (subpackage, [(public name, its module)]); the package itself is ''."""
    folder = ROOT / 'src' / package
    for path in [folder / '__init__.py', *sorted(folder.glob('*/__init__.py'))]:
        room = '' if path.parent == folder else path.parent.name
        here = '.'.join(part for part in (package, room) if part)
        exports = exports_of(path.read_text(encoding='utf-8'))
        names = [(name, _home(resolve_name(module, here), name)) for name, module in exports.items()]
        if names:
            yield room, names
