"""Reference pages from the sources: public Python names from the lists of the packages, messages from their files."""
import ast
import importlib
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


def _kind(home, name):
    """Return Sphinx's directive for a name of a module, from its source, as not all modules can be imported."""
    path = (ROOT / 'src').joinpath(*home.split('.'))
    text = (path / '__init__.py' if path.is_dir() else path.with_suffix('.py')).read_text(encoding='utf-8')
    found = {getattr(node, 'name', ''): node for node in ast.parse(text).body}.get(name)
    return {ast.ClassDef: 'autoclass', ast.FunctionDef: 'autofunction'}.get(type(found), 'autodata')


def _rooms(package):
    """Yield (subpackage, [(public name, its module)]); the package itself is ''."""
    folder = ROOT / 'src' / package
    for path in [folder / '__init__.py', *sorted(folder.glob('*/__init__.py'))]:
        room = '' if path.parent == folder else path.parent.name
        here = '.'.join(part for part in (package, room) if part)
        names = [(name, here + module) for name, module in exports_of(path.read_text(encoding='utf-8')).items()]
        if names:
            yield room, names
