"""The page of a replay, as a text: what it holds, that it needs nothing else, and that it replaces nothing else."""
import base64
import json
import re
import zlib
from pathlib import Path

import pytest

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.runs.states import NAMES, STATES
from move_base_abstract_replay import page as page_module
from move_base_abstract_replay.packed import Packer
from move_base_abstract_replay.page import write_page
from move_base_abstract_replay.recording import ReplayError
from test_replay_recording import S, log_text

ROOT = Path(__file__).resolve().parents[2]
MAP = ROOT / 'maps' / 'farm_yard.yaml'
PIECES = [S, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0], [5 * S, 4.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]
LEG = [(S, 'r', 'departed', (4.0, 0.0, 0.0)), (S, 'r', 'pieces', PIECES),
       (5 * S, 'r', 'stands', (4.0, 0.0, 0.0)), (5 * S, 'r', 'ended', ('g', 'SUCCEEDED', 'Goal reached.'))]


@pytest.fixture
def log(tmp_path):
    """Return what writes entries as the log of a name."""
    def write(name, entries):
        (tmp_path / name).write_text(log_text(entries))
        return tmp_path / name
    return write


def unpacked(text):
    """Return (about, {name: bytes}) of a packed text, as data.js reads it."""
    data = zlib.decompress(base64.b64decode(text))
    length = int.from_bytes(data[:4], 'little')
    head = json.loads(data[4:4 + length])
    size = {'f8': 8, 'u4': 4, 'u2': 2, 'u1': 1, 'text': 1}
    columns = {name: data[4 + length + begin:4 + length + begin + count * size[kind]]
               for name, (kind, begin, count) in head['columns'].items()}
    return head['about'], columns


def test_what_is_packed_comes_out_and_numbers_lie_where_typed_arrays_may_begin():
    packer = Packer()
    packer.add('a', 'u1', [1, 2, 3])
    packer.add('b', 'f8', [0.5])
    packer.add('c', 'text', ['x', 'é'])
    data = zlib.decompress(base64.b64decode(packer.text({'k': 1})))
    assert (4 + int.from_bytes(data[:4], 'little')) % 8 == 0
    head = json.loads(data[4:4 + int.from_bytes(data[:4], 'little')])
    assert {name: begin for name, (_, begin, _) in head['columns'].items()} == {'a': 0, 'b': 8, 'c': 16}
    about, columns = unpacked(packer.text({'k': 1}))
    assert (about, columns['a'], columns['c'].decode()) == ({'k': 1}, b'\1\2\3', 'x\né')
    assert columns['b'] == b'\0\0\0\0\0\0\xe0\x3f'


def test_the_page_holds_the_log_and_loads_nothing(log, tmp_path):
    page = tmp_path / 'replay.html'
    assert write_page([log('run.jsonl', LEG)], page, MAP) == []
    text = page.read_text()
    about, columns = unpacked(re.search(r'data-run>([^<]+)<', text).group(1))
    assert (about['begin'], about['end'], about['rows']) == (S, 5 * S, [{'name': 'r', 'robot': True}])
    assert len(columns['event_time']) == 8 * 4
    assert unpacked(re.search(r'id="packed-map">([^<]+)<', text).group(1))[0]['resolution'] == pytest.approx(0.1)
    assert "default-src 'none'" in text
    assert not re.search(r'(?:https?:)?//[\w.]+\.\w+/|\bsrc=|@import|url\(', text)


def test_a_leg_of_an_older_log_is_drawn_evenly_and_a_note_says_so(log, tmp_path):
    for name, entries, noted in (('new', LEG, False), ('old', [LEG[0], *LEG[2:]], True)):
        write_page([log(name, [(S, 'r', 'stands', (0.0, 0.0, 0.0)), *entries])], tmp_path / (name + '.html'))
        text = (tmp_path / (name + '.html')).read_text()
        assert '<li>1 leg</li>' in text
        assert ('<li>1 leg without its motion in the log: drawn straight, at an even speed' in text) == noted
    about, columns = unpacked(re.search(r'data-run>([^<]+)<', (tmp_path / 'new.html').read_text()).group(1))
    assert columns['event_values'].decode().split('\n')[2] == '[2]'  # the map has the pieces


def test_equal_logs_give_equal_pages(log, tmp_path):
    for name in ('one.html', 'two.html'):
        write_page([log('run.jsonl', LEG)], tmp_path / name)
    assert (tmp_path / 'one.html').read_bytes() == (tmp_path / 'two.html').read_bytes()


def test_texts_of_others_are_no_markup(log, tmp_path):
    write_page([log('run<b>.jsonl', [*LEG, (5 * S, '</script><i>', 'x', ('<script>',))])], tmp_path / 'p.html')
    text = (tmp_path / 'p.html').read_text()
    assert 'run&lt;b&gt;.jsonl' in text and '<b>' not in text and '<i>' not in text


def test_bytes_that_are_no_text_are_shown_as_codes(log, tmp_path):
    paths = [log('a.jsonl', LEG), log('b.jsonl', LEG)]
    text = paths[1].read_bytes().replace(b'"r"', b'"\xff"')
    paths[1].write_bytes(text.replace(b'because": []', b'because": ["\xff"]'))
    write_page(paths, tmp_path / 'p.html')
    assert '\\udcff' in (tmp_path / 'p.html').read_text(encoding='utf-8')


def test_a_page_is_replaced_and_nothing_else_is(log, tmp_path):
    run, page = log('run.jsonl', LEG), tmp_path / 'p.html'
    write_page([run], page)
    write_page([run], page)
    page.write_text('<!doctype html>\nmine')
    with pytest.raises(ConfigurationError, match='p.html: is there already'):
        write_page([run], page)
    assert page.read_text() == '<!doctype html>\nmine'


def test_a_log_without_robots_has_a_page_without_a_map(log, tmp_path):
    write_page([log('run.jsonl', [(S, 'asker', 'answer', ('yes',))])], tmp_path / 'p.html')
    text = (tmp_path / 'p.html').read_text()
    assert 'class="nowhere"' in text and '1 other name' in text and 'No robot of this log says where it is' in text


def test_two_logs_are_compared_and_the_first_difference_is_told(log, tmp_path):
    other = [*LEG[:2], (6 * S, 'r', 'stands', (4.0, 0.0, 0.0))]
    write_page([log('a.jsonl', LEG), log('b.jsonl', other)], tmp_path / 'p.html')
    text = (tmp_path / 'p.html').read_text()
    assert json.loads(re.search(r'id="about">(.*?)<', text).group(1))['difference'] == {'time': 5 * S, 'event': 2}
    assert 'The first difference is at 5.000000000 s' in text
    write_page([log('a.jsonl', LEG), log('b.jsonl', LEG)], tmp_path / 'p.html')
    assert 'hold the same events' in (tmp_path / 'p.html').read_text()


def test_three_logs_are_an_error(log, tmp_path):
    with pytest.raises(ReplayError, match='got 3 logs'):
        write_page([log('a.jsonl', LEG)] * 3, tmp_path / 'p.html')


def test_the_states_of_the_page_are_those_of_the_table_and_stand_nowhere_else(log, tmp_path, monkeypatch):
    more = STATES[0]._replace(name='paused', colours=('#000001', '#000002', '#000003'), stands_out=True)
    monkeypatch.setattr(page_module, 'STATES', (*STATES, more))
    write_page([log('run.jsonl', LEG)], tmp_path / 'p.html')
    text = (tmp_path / 'p.html').read_text()
    for state in (*STATES, more):
        assert [text.count('--{}: {};'.format(state.name, colour)) > 0 for colour in state.colours] == [True] * 3
        assert '{{"name": "{}", "standsOut": {}}}'.format(state.name, str(state.stands_out).lower()) in text
    assert re.findall(r'<i class="(\w+)" style="background: var', text) == ['driving', 'idle']
    for path in (ROOT / 'src' / 'move_base_abstract_replay' / 'templates').iterdir():
        assert not re.search('--({}):'.format('|'.join(NAMES)), path.read_text()), path


def test_the_script_reads_each_colour_that_it_draws_with():
    folder = ROOT / 'src' / 'move_base_abstract_replay' / 'templates'
    listed = re.search(r'of \[(.*?)\.\.\.STATES', (folder / 'canvas.js').read_text(), re.DOTALL).group(1)
    drawn = re.findall(r'COLOURS\.(\w+)', ''.join(path.read_text() for path in folder.glob('*.js')))
    assert set(drawn) <= {*re.findall(r"'(\w+)'", listed), *NAMES}
