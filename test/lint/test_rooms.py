"""The rooms of the source: one can survey the modules of each. Their borders are in pyproject.toml."""
import ast
import re
from pathlib import Path

import pytest

from move_base_abstract.common.lazy_exports import exports_of

ROOT = Path(__file__).resolve().parents[2]
SRC = ROOT / 'src'
MOST_MODULES = 25  # in Python and in C++, where a header and its source are one
#: packages with rooms; pyproject.toml says which room may import which (import-linter)
PACKAGES = ('move_base_abstract', 'move_base_abstract_ros', 'move_base_abstract_ros/lockstep',
            'move_base_abstract_experiments', 'soil_mapping')
#: what a unit test has no use for: it does not wait, and uses no network
NOT_IN_UNIT_TESTS = {'time.sleep', 'http', 'http.client', 'http.server', 'urllib.request', 'xmlrpc.client'}


def rooms_of(package):
    return sorted(path.parent for path in (SRC / package).glob('*/__init__.py'))


@pytest.mark.parametrize('package', PACKAGES)
def test_every_room_is_below_its_house_and_has_a_sentence(package):
    borders = (ROOT / 'pyproject.toml').read_text().split('[tool.importlinter]')[1]
    layers = re.search(r'containers = \["{}"\]\nlayers = (.*)'.format(package.replace('/', '.')), borders)
    houses = borders.split('layers = [')[1].split('\n]\n')[0]
    modules = [path for path in sorted((SRC / package).glob('*.py')) if path.stem != '__init__']
    for room in [*rooms_of(package), *modules]:
        name = room.stem if layers else '.'.join(room.relative_to(SRC).with_suffix('').parts)
        assert re.search(rf'[ "]{re.escape(name)}[ "]', layers.group(1) if layers else houses), name
        text = (room / '__init__.py' if room.is_dir() else room).read_text()
        assert ast.get_docstring(ast.parse(text)), room


def test_unit_tests_do_not_wait_and_use_no_network():
    for path in sorted((ROOT / 'test' / 'unit').rglob('*.py')):
        for node in ast.walk(ast.parse(path.read_text())):
            names = {alias.name for alias in node.names} if isinstance(node, ast.Import) else {
                getattr(node, 'module', '') if isinstance(node, ast.ImportFrom) else
                ast.unparse(node) if isinstance(node, ast.Attribute) else ''}
            assert not names & NOT_IN_UNIT_TESTS, path


def modules_of(folder):
    """Return the names of a folder's modules."""
    return {path.stem for path in folder.glob('*.*') if path.suffix in ('.py', '.h', '.cpp')} - {'__init__'}


@pytest.mark.parametrize('folder', [
    path.relative_to(ROOT).as_posix() for name in ('src', 'include') for path in sorted((ROOT / name).rglob('*'))
    if path.is_dir() and modules_of(path)])
def test_every_room_has_few_modules(folder):
    assert len(modules_of(ROOT / folder)) <= MOST_MODULES


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
