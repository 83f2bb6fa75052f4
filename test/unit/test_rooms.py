"""The rooms of the core: what is below may not know what is above, and no room has more modules than one can survey."""
import ast
import importlib
import re
from pathlib import Path

import pytest

SRC = Path(__file__).resolve().parents[2] / 'src'
CORE = SRC / 'move_base_abstract'
MOST_MODULES = 25
# Each room, and those below it that it may import from. `common` is for all.
MAY_IMPORT = {
    'common': '', 'engine': '', 'runs': '', 'supervision': '', 'lockstep': '', 'motion': 'engine', 'maps': 'motion',
    'goals': 'engine motion maps', 'faults': 'engine goals', 'energy': 'engine goals',
    'traffic': 'engine motion maps goals', 'tasks': 'engine motion goals runs',
    'config': 'motion maps goals faults energy', 'scenario': 'config motion traffic tasks', 'mission': 'motion',
    'fleet': 'scenario config tasks traffic energy faults goals maps motion engine runs'}


def imports_of(path):
    """Return the modules of the package that a file imports, as tuples of names below the package."""
    base = path.relative_to(SRC).with_suffix('').parts[:-1]
    found = []
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom):
            parts = base[:len(base) - (node.level - 1)] if node.level else ()
            parts = (*parts, *(node.module or '').split('.')) if node.module else parts
            found += [(*parts, alias.name) for alias in node.names] if parts else []
        elif isinstance(node, ast.Import):
            found += [tuple(alias.name.split('.')) for alias in node.names]
    return [parts[1:] for parts in found if parts[0] == 'move_base_abstract' and len(parts) > 1]


def room_of(parts):
    """Return the room of a module by the names below the package."""
    return parts[0]


def files():
    return sorted(path for path in CORE.rglob('*.py') if path.parent != CORE or path.name != '__init__.py')


@pytest.mark.parametrize('path', files(), ids=lambda path: str(path.relative_to(CORE)))
def test_a_room_knows_only_those_below_it(path):
    own = path.relative_to(CORE).with_suffix('').parts[0]
    for parts in imports_of(path):
        if parts[0] != own:
            assert parts[0] in ('common', *MAY_IMPORT[own].split()), f'{own} must not import {".".join(parts)}'


def test_there_are_no_circles_among_the_rooms():
    known = {'common'}
    left = {room: set(below.split()) for room, below in MAY_IMPORT.items() if room != 'common'}
    while left:
        free = sorted(room for room, below in left.items() if below <= known)
        assert free, f'a circle among {sorted(left)}'
        for room in free:
            known.add(room)
            del left[room]


def test_every_room_is_listed_and_has_few_modules_and_a_sentence():
    rooms = sorted(path.parent for path in CORE.glob('*/__init__.py'))
    assert {path.name for path in rooms} | {'scenario', 'mission'} == set(MAY_IMPORT)
    for room in rooms:
        assert len([path for path in room.glob('*.py') if path.name != '__init__.py']) <= MOST_MODULES, room
        assert ast.get_docstring(ast.parse((room / '__init__.py').read_text())), room


@pytest.mark.parametrize('room', sorted(path.parent.name for path in CORE.glob('*/__init__.py')))
def test_the_names_that_a_room_hands_on_are_there(room):
    text = (CORE / room / '__init__.py').read_text()
    package = importlib.import_module('move_base_abstract.' + room)
    names = [name for own in re.findall(r"'[a-z_]+': '([A-Za-z_ ]+)'", text) for name in own.split()]
    assert names or room == 'lockstep'
    for name in names:
        assert getattr(package, name).__name__ == name
    with pytest.raises(AttributeError, match='has no attribute'):
        importlib.import_module(package.__name__).__getattr__('what_nobody_hands_on')


def test_what_users_need_is_at_the_door():
    import move_base_abstract
    from move_base_abstract.fleet.fleet import Fleet
    assert move_base_abstract.Fleet is Fleet
    assert {'make_scenario', 'read_scenario'} <= set(dir(move_base_abstract.scenario))
