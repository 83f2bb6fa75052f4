"""What a program's own code asks for by names that are made in C is handed on, and nothing else is changed."""
import ast
import datetime
import json
import threading

import pytest

from move_base_abstract.lockstep.call_rewriting import ASK, FILE_TIME, HASHED, KEPT, SHOWING, SHOWN, ask, ask_present
from move_base_abstract.lockstep.stable_hash import Address


def run(text, **names):
    """Return the names of a text that was run, and what was handed on: [value, ...] for each of the two."""
    asked, hashed = [], []
    names.update({ASK: lambda what: asked.append(what) or what, HASHED: lambda value: hashed.append(value) or value,
                  KEPT: lambda what: lambda *of: Address(what(*of)), SHOWN: lambda text, _how: text})
    exec(compile(ask(ast.parse(text)), 'text', 'exec'), names)
    return names, asked, hashed


@pytest.mark.parametrize('text', [
    'import datetime\nnow = datetime.datetime.now()', 'from datetime import datetime as d\nnow = d.now()',
    'from datetime import datetime\nread = datetime.now\nnow = read()'])
def test_a_date_of_the_present_is_handed_on_under_any_name(text):
    names, asked, _hashed = run(text)
    assert asked == [datetime.datetime.now]  # noqa: TID251 - not called
    assert isinstance(names['now'], datetime.datetime)


def test_in_a_library_only_dates_of_the_present_are_handed_on():
    asked = []
    text = 'from datetime import datetime\nread = datetime.now\nx = id(read), hash(read), repr(read), read()'
    exec(compile(ask_present(ast.parse(text)), 'text', 'exec'), {ASK: lambda what: asked.append(what) or what})
    assert asked == [datetime.datetime.now]  # noqa: TID251 - not called


@pytest.mark.parametrize('text', ['x = id(a)', 'sorted([a], key=id)', "x = '%d' % id(a)", 'x = id(a) % 7',
                                  'x = [id(a)]', 'str(id(a))', 'd = {1: id(a)}', 'd = {1: 2}; d.get(1, 2 + id(a))'])
def test_an_address_that_shows_is_handed_on(text):
    assert run(text, a=object())[1] == [id]


@pytest.mark.parametrize('text', ['id(a) == id(b)', 'id(a) in {}', 's = set(); s.add(id(a)); s.discard(id(a))',
                                  'd = {id(a): 1}; d[id(a)] = 2; d.pop(id(a))', 'd = {id(x): x for x in [a]}'])
def test_an_address_that_is_compared_or_a_key_is_not(text):
    assert run(text, a=object(), b=object())[1] == []


@pytest.mark.parametrize('text', ['x = {id(a): a}', 'x = {id(b): b for b in [a]}', 'x = {}; x[id(a)] = a',
                                  'x = set(); x.add(id(a))', 'x = {}; x.setdefault(id(a), a)'])
def test_an_address_that_is_kept_as_a_key_is_handed_to_one_that_sees_what_becomes_of_it(text):
    names, asked, _hashed = run(text, a=object())
    assert (asked, [type(key) for key in names['x']]) == ([], [Address])


@pytest.mark.parametrize('text', ['x = id(a) < id(b)', 'x = id(a) == 1 > id(b)'])
def test_an_address_that_decides_an_order_is_handed_on(text):
    assert set(run(text, a=object(), b=object())[1]) == {id}


@pytest.mark.parametrize(('text', 'shown'), [
    ('x = str(a)', [('1', 'str')]), ("x = f'{a:>2}' + '-'", [(' 1', 'f-string')]), ("x = '%s' % a", [('1', '%')]),
    ("x = '{}'.format(a)", [('1', 'format')]), ('x = a.__repr__()', [('1', '__repr__')]), ('x = a % 2', []),
    ("loginfo('%s' % a)", []), ('print(str(a))', []), ('x = sorted([a], key=repr)', ['repr']),
    ('x = list(map(str, [a]))', ['str']), ('json.dumps(a, default=str)', ['str', ('1', 'dumps')]), ('x = int(a)', [])])
def test_a_text_that_may_show_an_address_is_handed_on_if_it_is_not_only_logged(text, shown):
    seen = []
    names = {'a': 1, 'json': json, 'loginfo': len, SHOWN: lambda text, how: seen.append((text, how)) or text,
             SHOWING: lambda what: seen.append(what.__name__) or what}
    exec(compile(ask(ast.parse(text)), 'text', 'exec'), names)
    assert seen == shown


@pytest.mark.parametrize(('text', 'expected'), [
    ('x = get_ident()', 1), ('import threading\nx = [threading.get_ident()]', 1),
    ('d = {}; d[get_ident()] = 1; get_ident() in d', 0)])
def test_the_address_of_a_thread_is_handed_on_as_any_other(text, expected):
    assert run(text, get_ident=threading.get_ident)[1] == [threading.get_ident] * expected


def test_hash_is_handed_on_itself_where_it_is_not_called():
    names, asked, hashed = run('x = sorted([a], key=hash)\ny = hash(a)', a='a')
    assert (asked, hashed) == ([hash], ['a'])
    assert (names['x'], names['y']) == (['a'], hash('a'))


@pytest.mark.parametrize('text', ['x = object.__hash__(a)', 'x = a.__hash__()'])
def test_a_hash_that_is_asked_for_by_its_name_is_handed_on(text):
    names, asked, _hashed = run(text, a=5)
    assert [one.__name__ for one in asked] == ['__hash__'] and isinstance(names['x'], int)


def test_times_of_files_are_handed_on():
    seen = []
    text = ("import os, pathlib\na = os.stat('.').st_mtime\nb = pathlib.Path('.').stat().st_ctime_ns\n"
            "c = os.stat('.').st_size")
    names = {FILE_TIME: lambda value: seen.append(value) or value}
    exec(compile(ask(ast.parse(text)), 'text', 'exec'), names)
    assert seen == [names['a'], names['b']]


def test_names_of_the_program_stay_what_they_are():
    names, asked, hashed = run('id = 5\nx = id + 1\nclass T:\n  now = 3\ny = T.now\nT.now = 4\nz = hash(T.now)')
    assert (names['x'], names['y'], names['z']) == (6, 3, 4)
    assert (asked, hashed) == ([5, 3, 4], [4])
