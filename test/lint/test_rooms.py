"""The rooms of the source: what is below may not know what is above, and one can survey the modules of each."""
import ast
import re
from pathlib import Path

import pytest

from move_base_abstract.common.lazy_exports import exports_of

ROOT = Path(__file__).resolve().parents[2]
SRC = ROOT / 'src'
MOST_MODULES = 25  # in Python and in C++, where a header and its source are one
MOST_METHODS = 20  # of a class in Python, properties counted; docs/architecture.md lists those with more, and why
# Of each package: each room or module at its door, and those below it that it may import from, besides LOWEST.
LOWEST = {'move_base_abstract': 'common'}
MAY_IMPORT = {
    'move_base_abstract': {
        'common': '', 'engine': '', 'lockstep': '', 'runs': 'lockstep', 'properties': 'lockstep runs',
        'supervision': '', 'motion': 'engine',
        'maps': 'motion', 'goals': 'engine motion maps', 'faults': 'engine maps goals', 'energy': 'engine goals',
        'traffic': 'engine motion maps goals', 'encounters': 'engine motion maps goals',
        'sensing': 'engine motion maps', 'tasks': 'engine motion goals runs',
        'orders': 'engine motion goals tasks',
        'config': 'motion maps goals faults energy sensing', 'scenario': 'config energy motion traffic tasks orders',
        'mission': 'motion', 'radio': 'motion maps',
        'fleet': 'scenario config sensing tasks orders traffic encounters energy faults goals maps motion engine runs',
        'processes': 'fleet scenario goals runs'},
    'move_base_abstract_ros': {
        'replacing': '', 'loopback': '', 'time_master_client': '', 'process': 'replacing',
        'lockstep': 'replacing process', 'messages': 'lockstep', 'goal_client': 'messages',
        'transforms': 'replacing lockstep messages', 'maps': 'lockstep messages', 'map_files': '',
        'markers': 'lockstep messages', 'clocks': 'process lockstep messages transforms',
        'backends': 'lockstep messages transforms clocks',
        'robot': 'replacing lockstep messages transforms maps markers clocks backends',
        'fleet': 'replacing messages markers robot', 'adopting': '',
        'launching': 'replacing loopback lockstep messages adopting',
        'nodes': 'replacing loopback process lockstep messages transforms maps markers clocks backends robot fleet '
                 'adopting launching'},
    'move_base_abstract_ros/lockstep': {
        'code': '', 'programs': '', 'ros_master': '', 'exchange': 'ros_master', 'failing': 'code',
        'machine': 'code programs', 'waiting': 'code ros_master failing',
        'participation': 'ros_master exchange failing waiting',
        'program': 'code programs ros_master failing machine waiting participation'},
    'move_base_abstract_experiments': {
        'records': '', 'ending': '', 'description': 'records', 'report': 'records', 'trials': 'records description',
        'carrying': 'description trials', 'results': 'records description trials carrying',
        'sweep': 'records description trials carrying results report',
        'rerun': 'records description trials carrying results',
        'command': 'description trials results report sweep rerun ending', '__main__': 'command',
        'chaos': 'records description trials carrying results ending', 'fleet_report': ''},
    'soil_mapping': {
        'config': '', 'seeds': '', 'stopwatch': '', 'environment': '', 'interpolation': '',
        'ground_truth': 'config seeds interpolation', 'mission': 'config seeds stopwatch interpolation',
        'results': 'seeds mission',
        'mesa_models': 'config stopwatch interpolation ground_truth mission results',
        'ros': 'config stopwatch environment ground_truth mission results',
        'study': 'config stopwatch environment ground_truth mission results mesa_models ros',
        'nodes': 'environment ros study'}}
OF_THE_CORE = {  # what these rooms of ROS may know of the core: nothing of robots
    'replacing': 'common', 'loopback': 'common', 'time_master_client': 'srv msg',
    'process': 'common', 'lockstep': 'common lockstep properties runs'}


def imports_of(path):
    """Return all modules and names that a file imports, as tuples of names."""
    base = path.relative_to(SRC).with_suffix('').parts[:-1]
    found = []
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom):
            parts = base[:len(base) - (node.level - 1)] if node.level else ()
            parts = (*parts, *(node.module or '').split('.')) if node.module else parts
            found += [(*parts, alias.name) for alias in node.names] if parts else []
        elif isinstance(node, ast.Import):
            found += [tuple(alias.name.split('.')) for alias in node.names]
    return found


def files():
    """Return (package, room, path) of all modules but those of the packages themselves."""
    return [(package, path.relative_to(SRC / package).with_suffix('').parts[0], path)
            for package in MAY_IMPORT for path in sorted((SRC / package).rglob('*.py'))
            if path != SRC / package / '__init__.py']


def rooms_of(package):
    return sorted(path.parent for path in (SRC / package).glob('*/__init__.py'))


@pytest.mark.parametrize('package, own, path', files(), ids=lambda value: getattr(value, 'stem', value))
def test_a_room_knows_only_those_below_it(package, own, path):
    allowed = {own, LOWEST.get(package), *MAY_IMPORT[package][own].split()}
    depth = package.count('/') + 1
    for parts in imports_of(path):
        if '/'.join(parts[:depth]) == package and len(parts) > depth:
            assert parts[depth] in allowed, f'{own} must not import {".".join(parts)}'
        elif package == 'move_base_abstract_ros' and own in OF_THE_CORE and parts[0] == 'move_base_abstract':
            of_robots = parts[1:2] and parts[1] not in OF_THE_CORE[own].split()
            assert not of_robots, f'{own} must not know {".".join(parts)}'


@pytest.mark.parametrize('package', MAY_IMPORT)
def test_there_are_no_circles_among_the_rooms(package):
    known = {LOWEST.get(package)}
    left = {room: set(below.split()) for room, below in MAY_IMPORT[package].items() if room not in known}
    while left:
        free = sorted(room for room, below in left.items() if below <= known)
        assert free, f'a circle among {sorted(left)}'
        for room in free:
            known.add(room)
            del left[room]


@pytest.mark.parametrize('package', MAY_IMPORT)
def test_every_room_is_listed_and_has_a_sentence(package):
    folders = [path for path in (SRC / package).iterdir() if path.is_dir() and any(path.glob('*.py'))]
    assert sorted(folders) == rooms_of(package)
    doors = {path.stem for path in (SRC / package).glob('*.py')} - {'__init__'}
    assert {path.name for path in folders} | doors == set(MAY_IMPORT[package])
    for room in folders:
        assert ast.get_docstring(ast.parse((room / '__init__.py').read_text())), room


def modules_of(folder):
    """Return the names of a folder's modules."""
    return {path.stem for path in folder.glob('*.*') if path.suffix in ('.py', '.h', '.cpp')} - {'__init__'}


@pytest.mark.parametrize('folder', [
    path.relative_to(ROOT).as_posix() for name in ('src', 'include') for path in sorted((ROOT / name).rglob('*'))
    if path.is_dir() and modules_of(path)])
def test_every_room_has_few_modules(folder):
    assert len(modules_of(ROOT / folder)) <= MOST_MODULES


def large_classes():
    """Return [(name, methods), ...] of the classes in Python that have more than is usual."""
    classes = [node for path in sorted(SRC.rglob('*.py')) for node in ast.walk(ast.parse(path.read_text()))
               if isinstance(node, ast.ClassDef)]
    sizes = [(node.name, sum(isinstance(each, (ast.FunctionDef, ast.AsyncFunctionDef)) for each in node.body))
             for node in classes]
    return sorted((name, size) for name, size in sizes if size > MOST_METHODS)


def test_a_class_has_few_methods_or_a_reason_for_each_that_it_has_more():
    text = (ROOT / 'docs' / 'architecture.md').read_text().split('## Large classes')[1].split('\n## ')[0]
    rows = re.findall(r'^\| `(\w+)` \| (\d+) \| (\S.*) \|$', text, re.MULTILINE)
    assert large_classes() == sorted((name, int(size)) for name, size, _reason in rows)


def test_each_room_of_the_core_exports_names():
    rooms = [room for room in rooms_of('move_base_abstract') if room.name != 'lockstep']
    assert [room.name for room in rooms if not exports_of((room / '__init__.py').read_text())] == []


def test_what_users_need_is_at_the_door():
    import move_base_abstract
    from move_base_abstract.fleet.fleet import Fleet
    assert move_base_abstract.Fleet is Fleet
    with pytest.raises(AttributeError, match="module 'move_base_abstract' has no attribute 'Flet'"):
        move_base_abstract.Flet  # noqa: B018
    assert {'make_scenario', 'read_scenario'} <= set(dir(move_base_abstract.scenario))
