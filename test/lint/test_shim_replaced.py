"""What the preloaded library replaces: the table in its sources, and the page that shows it to people."""
import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SHIM = ROOT / 'src' / 'roscpp_shim'
ROW = re.compile(r'^REPLACED(?:_C)?\(([\w+]+), "([^"]+)", (?:"([^"]+)",\s+)?(\w+)\)$', re.MULTILINE)


def rows():
    """Return [(library, since, name, symbol), ...]."""
    text = (SHIM / 'machine' / 'replaced.def').read_text(encoding='utf-8')
    found = ROW.findall(text)
    assert len(found) == text.count('\nREPLACED')
    return [(library, since, name or symbol + '()', symbol) for library, since, name, symbol in found]


def test_the_page_has_the_table():
    page = (ROOT / 'docs' / 'lockstep_roscpp_replaced.md').read_text(encoding='utf-8')
    shown = re.findall(r'^\| `([^`]+)` \| ([\w+]+) (\S+) \| .+ \|$', page, re.MULTILINE)
    assert shown == [(name, library, since) for library, since, name, _symbol in rows()]


def test_each_symbol_is_there_once_and_is_asked_for_somewhere():
    symbols = [row[3] for row in rows()]
    assert len(set(symbols)) == len(symbols)
    sources = [*sorted(SHIM.rglob('*.cpp')), *sorted((ROOT / 'src' / 'libc').glob('*.h'))]
    text = ''.join(path.read_text(encoding='utf-8') for path in sources)
    asked = set(re.findall(
        r'\b(?:real(?:<[^\"]+>)?|Real<[^\"]+> \w+)\(\s*(?:&[\w:]+,\s*)?"([^"]+)"\)', text))
    found = {name: [symbol for _, _, one, symbol in rows() if name in (symbol, one) or one.startswith(name + '(')]
             for name in asked}
    assert {name: some for name, some in found.items() if len(some) != 1} == {}
    # usleep() and sleep() are nanosleep() here, two are memalign(), those with 64 are those without, bind() is a system
    # call; a pass through roscpp's own processPublishQueues() is replaced whole.
    assert {symbol for some in found.values() for symbol in some} == set(symbols) - {
        'usleep', 'sleep', 'aligned_alloc', 'posix_memalign', 'bind', 'open64', 'openat64', '__open64_2', 'fopen64',
        'mmap64', 'stat64', 'lstat64', '__xstat64', '__lxstat64', 'readdir64', 'scandir64',
        '_ZN3ros12TopicManager20processPublishQueuesEv'}
