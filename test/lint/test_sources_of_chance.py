"""The page of sources of time and chance has a row for each function that the code follows or tells, and no other."""
import ast
import re
from pathlib import Path

import pytest
import test_shim_replaced

from move_base_abstract_ros.replacing import replaced

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / 'docs' / 'sources_of_chance.md'
LOCKSTEP = ROOT / 'src' / 'move_base_abstract_ros' / 'lockstep'
MACHINE = LOCKSTEP / 'machine'
#: of Python's: names of a clock, of a sleep, of chance, of the machine
PYTHON_SOURCE = re.compile(
    r'(time|uuid|os|gc|_posixsubprocess|random|tempfile|numpy|resource|signal|select(?:ors)?|socket\.socket)\.(?!_exit$)|'
    r'threading\._(time|newname)$|queue\.time$|logging\._log')
#: what is a source without being replaced: it is seeded, or the program's text has it handed on
FOLLOWED = {'random', 'numpy.random', 'datetime.now', 'datetime.utcnow', 'datetime.today', 'date.today', 'tempfile',
            'concurrent.futures', 'multiprocessing.pool', 'uuid.uuid4', 'asyncio', 'sqlite3', 'logging', 'repr',
            'numpy.datetime64'}
LABELLED = {'id', 'hash', 'logging.Formatter', 'xmlrpc.client.ServerProxy', 'threading.Thread.start',
            'threading.get_ident', 'os.stat', 'rospy.get_param'}
#: what is labelled by a name that the code does not say in the call that labels
BY_NAME = {'str', 'ascii', 'format', '%', 'json.dumps', 'pprint.pformat', 'traceback.format_exc', 'getPid',
           'getBusStats', 'getBusInfo', 'os.readlink', 'threading.Thread.ident', 'threading.Thread.native_id',
           'multiprocessing.process.BaseProcess.ident', 'multiprocessing.process.BaseProcess.pid'}
#: of the library that is preloaded into Python programs
NATIVE = 'Libraries in C of Python programs'
KINDS = {'followed', 'labelled', 'partly'}


def table(language):
    """Return the rows of a language: [(functions, kind, why, tests), ...], each function without its backticks."""
    text = PAGE.read_text(encoding='utf-8').split('\n## {}\n'.format(language))[1].split('\n## ')[0]
    rows = [[cell.strip() for cell in line.strip('|').split(' | ')] for line in text.splitlines()
            if line.startswith('| ') and not line.startswith('| function')]
    return [(re.findall(r'`([^`]+)`', names), kind, why, re.findall(r'`(test_\w+)`', tests))
            for names, kind, why, tests in rows]


def functions(language):
    """Return the functions of a language's rows that a table of the code can have, in order."""
    return [name for names, _kind, _why, _tests in table(language) for name in names]


def literals(path, name):
    """Return the value that a module gives to ``name``, of which the keys or items are constants."""
    for node in ast.parse(path.read_text(encoding='utf-8')).body:
        if isinstance(node, ast.Assign) and node.targets[0].id == name:
            nodes = node.value.keys if isinstance(node.value, ast.Dict) else node.value.elts
            return [ast.literal_eval(one) for one in nodes]
    raise AssertionError('{} has no {}'.format(path, name))


def test_each_function_that_the_library_stands_in_front_of_has_its_row():
    sources = [name for library, _since, name, _symbol in test_shim_replaced.rows() if name != 'bind()' and (
        library.startswith('lib') or name in ('ros::WallTime::now()', 'ros::SteadyTime::now()'))]
    assert len(sources) > 70
    shown = [name for name in functions('C++') if name.endswith(')')]
    assert sorted(name for name in shown if '(' in name) == sorted(sources)


def test_each_name_of_python_has_its_row():
    replaced_ = {row.name for row in replaced.ROWS.values() if PYTHON_SOURCE.match(row.name)}
    told = set(literals(MACHINE / 'unrepeatable_calls.py', 'CALLS')) | {
        '_posixsubprocess.fork_exec', 'os.readlink'}
    events = set(literals(MACHINE / 'unrepeatable_calls.py', 'EVENTS')) | {'open', 'ctypes.dlsym'}
    assert told <= set(replaced.ROWS)
    replaced_ |= told
    kinds = {name: kind for names, kind, _why, _tests in table('Python') for name in names if ' ' not in name}
    assert {name for name, kind in kinds.items() if kind == 'labelled'} == told | events | LABELLED | BY_NAME
    assert {name for name, kind in kinds.items() if kind != 'labelled'} == replaced_ - told - LABELLED | FOLLOWED


def test_what_is_labelled_in_python_is_told_by_the_code():
    code = ''.join(path.read_text(encoding='utf-8') for path in sorted(LOCKSTEP.rglob('*.py')))
    told = set(re.findall(r"told\.tell\(.*?, '([\w. ]+)'", code))
    assert told == LABELLED | {'numpy.datetime64', 'asyncio', 'open', 'ctypes.dlsym', '_posixsubprocess.fork_exec',
                               'tempfile', 'chance', 'a clock'}


def test_each_function_that_libraries_of_python_programs_are_kept_from_has_its_row():
    text = (ROOT / 'src' / 'python_shim' / 'exports.map').read_text(encoding='utf-8')
    symbols = re.findall(r'\b(\w+);', re.sub(r'/\*.*?\*/', '', text, flags=re.DOTALL))
    assert len(symbols) > 50
    names = [('std::random_device::operator()()' if one.startswith('_Z') else one + '()', one) for one in symbols]
    assert sorted(functions(NATIVE)) == sorted(name for name, _symbol in names)
    sources = [*sorted((ROOT / 'src' / 'python_shim').glob('*.cpp')), *sorted((ROOT / 'src' / 'libc').glob('*.h'))]
    code = ''.join(path.read_text(encoding='utf-8') for path in sources)
    for _name, symbol in names:
        if '64' in symbol and f'.set {symbol}, ' in code:
            continue
        behind = 'nanosleep' if symbol in ('sleep', 'usleep') else symbol
        assert re.search(r'\b{}\('.format(symbol), code) and '("{}")'.format(behind) in re.sub(r'\s+', '', code), symbol
    told = {name for name, kind in native_kinds().items() if kind == 'labelled'}
    assert told == {name for name, symbol in names if re.search(
        r'\b{}\([^;{{}}]*\) \{{[^}}]*\b(?:tellUse|tellTimer|Start start)\('.format(symbol), code)}


def native_kinds():
    return {name: kind for names, kind, _why, _tests in table(NATIVE) for name in names}


def test_what_libraries_are_told_of_has_the_same_order_on_both_sides():
    native = (MACHINE / 'native.py').read_text(encoding='utf-8').replace('\\\n    ', '')
    for header, begin, count in (('notices.h', '_STRAY_CLOCK', 13), ('run.h', '_NOW', 12)):
        text = (ROOT / 'src' / 'python_shim' / header).read_text(encoding='utf-8')
        names = [re.sub('([A-Z])', r'_\1', name).upper() for name in re.findall(
            r'^  k(\w+)(?=,|$| )', re.search(r'enum (?:class )?(?:What|Cell) \{(.*?)\}', text, re.DOTALL).group(1),
            re.MULTILINE)]
        assert len(names) == count
        assert names == re.search(r'^({}, .*?) = '.format(begin), native, re.MULTILINE).group(1).split(', ')


@pytest.mark.parametrize('language', ['C++', 'Python', NATIVE])
def test_each_row_says_how_why_and_by_which_test(language):
    tests = ''.join(path.read_text(encoding='utf-8') for path in sorted((ROOT / 'test').rglob('*.py')))
    for names, kind, why, named in table(language):
        assert kind in KINDS, names
        assert len(why) > 5, names
        assert named, names
        for one in named:
            assert 'def {}('.format(one) in tests, one


def test_what_is_labelled_is_told_by_the_code():
    code = ''.join(path.read_text(encoding='utf-8') for path in sorted((ROOT / 'src' / 'roscpp_shim').rglob('*.cpp')))
    for names, kind, _why, _tests in table('C++'):
        for name in names:
            function = re.search(r'\b{}\([^;{{}}]*\) \{{(.*?)^\}}'.format(re.escape(name.replace('()', ''))), code,
                                 re.MULTILINE | re.DOTALL)
            if name.endswith('()') and '::' not in name and function:
                tells = re.search(r'\btell(?!dir)|addShared|DescriptorWait', function.group(1)) is not None
                assert kind == 'partly' or tells == (kind == 'labelled') or name == 'pthread_create()', name
