"""The one table of the wire format: what both sides say is what it says."""
import importlib.util
import inspect
import re
from pathlib import Path

import pytest

from move_base_abstract.lockstep import wire, wire_format

ROOT = Path(__file__).resolve().parents[2]
TABLES = {name: getattr(wire_format, name) for name in ('PARTICIPANT_FRAMES', 'MASTER_FRAMES', 'REPORT_ITEMS',
                                                        'GRANT_ITEMS')}
LAYOUTS = [layout for table in TABLES.values() for layout in table]
BYTES = {'text': 'ab', 'bytes': b'\0\xff', 'texts': ['a', 'bc'], 'flag': True, 'instant': wire_format.NEVER}


@pytest.fixture(scope='module')
def generator():
    spec = importlib.util.spec_from_file_location('make_wire_format', ROOT / 'src/lockstep/wire/make_wire_format.py')
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize('layout', LAYOUTS, ids=[layout.name for layout in LAYOUTS])
def test_the_header_has_a_structure_with_the_fields_in_their_order(generator, layout):
    header = generator.header(vars(wire_format))
    name = ''.join(part.capitalize() for part in layout.name.split('_'))
    body = re.search(r'^struct ' + name + r' \{(.*?)\};$', header, re.DOTALL | re.MULTILINE).group(1)
    names = [field.partition(' =')[0].split()[1] for field in layout.fields]
    assert re.findall(r'(\w+)(?: = [^;]+)?;', body) == names
    assert f'kTypeOf<{name}> = {layout.number};' in header
    read = re.search(r'^void fields\(' + name + r'&.*?\}$', header, re.DOTALL | re.MULTILINE).group()
    assert re.findall(r'visit\("(\w+)"', read) == [name for name in names if name != 'items']


@pytest.mark.parametrize('layout', TABLES['REPORT_ITEMS'], ids=[layout.name for layout in TABLES['REPORT_ITEMS']])
def test_python_makes_every_item_of_a_report_by_its_fields(layout):
    make = getattr(wire, layout.name.lower())
    assert list(inspect.signature(make).parameters) == [field.split()[1] for field in layout.fields]
    values = [BYTES.get(field.split()[0], 1) for field in layout.fields]
    item = make(*values)
    assert item[0] == layout.number
    assert wire._reader(wire._kinds(layout), 'B')(item, 0) == ((layout.number, *values), len(item))


@pytest.mark.parametrize('layout', TABLES['GRANT_ITEMS'], ids=[layout.name for layout in TABLES['GRANT_ITEMS']])
def test_python_reads_every_item_of_a_grant(layout):
    values = tuple(BYTES.get(field.split()[0], 1) for field in layout.fields)
    item = wire._writer('item', layout.fields, (('B', layout.number),))(*values)
    head = wire._writer('head', wire.FRAMES['GRANT'].fields)(7, 5, 3)
    assert wire.read_grant(head + item) == (7, 5, 3, [(getattr(wire, layout.name), *values)])


@pytest.mark.parametrize('layout', [layout for layout in TABLES['MASTER_FRAMES'] if layout.name != 'GRANT'],
                         ids=lambda layout: layout.name)
def test_python_reads_every_frame_of_the_time_master_and_refuses_one_cut_off(layout):
    values = tuple(BYTES.get(field.split()[0], 1) for field in layout.fields)
    body = wire._writer('frame', layout.fields)(*values)
    number = getattr(wire, layout.name)
    assert wire.read_frame(number, body) == values
    for length in range(len(body)):
        with pytest.raises(wire.WireError):
            wire.read_frame(number, body[:length])


def changed(**tables):
    return {**vars(wire_format), **tables}


@pytest.mark.parametrize('table, what', [
    (changed(GRANT_ITEMS=wire_format.GRANT_ITEMS[1:] + wire_format.GRANT_ITEMS[:1]), 'the numbers of GrantItem'),
    (changed(MASTER_FRAMES=wire_format.MASTER_FRAMES[:1] + wire_format.MASTER_FRAMES[2:]), 'numbers of MasterFrame'),
    (changed(CHOICES={'NoteKind': ((1, 'A'), (3, 'B'))}), 'the numbers of NoteKind'),
    (changed(REPORT_ITEMS=wire_format.REPORT_ITEMS + (wire_format.Layout(13, 'FOUND', ()),)), 'there twice'),
    (changed(NEVER=0), 'NEVER must be'),
], ids=['order', 'gap', 'choice', 'name', 'never'])
def test_a_table_that_contradicts_itself_is_refused(generator, table, what):
    with pytest.raises(ValueError, match=what):
        generator.header(table)


def test_a_header_that_says_the_same_is_left_alone(generator, tmp_path, monkeypatch):
    path = tmp_path / 'made' / 'wire_format.h'
    arguments = ['', str(ROOT / 'src/move_base_abstract/lockstep/wire_format.py'), str(path)]
    monkeypatch.setattr(generator.sys, 'argv', arguments)
    generator.main()
    before = path.stat()
    generator.main()
    assert (path.stat().st_ino, path.stat().st_mtime_ns) == (before.st_ino, before.st_mtime_ns)
