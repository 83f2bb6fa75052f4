"""What started a run, in a file beside its event log: ``A.jsonl.run`` for ``A.jsonl``. Debuggers start it again by it.

The log itself has nothing of it, because logs of equal runs are equal, whatever folder they were started in.
"""
from __future__ import annotations

import json
import re
from typing import Any, Dict, Iterable, Iterator, List, Mapping, NamedTuple, Sequence

from ..common.errors import ConfigurationError
from ..common.input_files import sha256_of
from ..common.json_files import load_json_mapping
from ..common.own_files import check_file, whole_file
from ..common.shown import shown
from ..common.version import package_version

FORMAT = 1
SUFFIX = '.run'
_PIECE = 1 << 20
#: names of environment variables on which runs may depend; launch files name others
_COUNTING = re.compile(r'(ROS|LD|MALLOC|GLIBC|OMP|OPENBLAS|MKL|BLIS|NUMEXPR|LC|MOVE_BASE_ABSTRACT)_\w+|PYTHON\w+|'
                       r'LANG|TZ|PATH|CMAKE_PREFIX_PATH')
#: of these, variables that each run sets anew
_OF_EACH_RUN = ('ROS_MASTER_URI', 'ROS_IP', 'ROS_HOSTNAME', 'ROS_LOG_DIR')
_LAUNCH_FILES = ('.launch', '.xml', '.test')
_NAMED = re.compile(r'\$\((?:opt)?env\s+(\w+)')


class Start(NamedTuple):
    """What started a run.

    ``words``: of `lockstep_launch`, without the path of its log; ``folder``: in which it was typed; ``environment``:
    the variables that count; ``digests``: {path: SHA-256} of launch files and programs; ``version``: of this package;
    ``program``: the words that begin the command in the place of `lockstep_launch`, if it is another one.
    """

    words: List[str]
    folder: str
    environment: Dict[str, str]
    digests: Dict[str, str]
    version: str
    program: List[str] = []

    def environment_again(self, now: Mapping[str, str]) -> Dict[str, str]:
        """Return the environment ``now``, with the variables that count as they were then."""
        kept = {name: value for name, value in now.items() if not _counts(name, ())}
        return {**kept, **self.environment, **{name: now[name] for name in _OF_EACH_RUN if name in now}}

    def changes(self) -> Iterator[str]:
        """Yield what is not as it was then, in words."""
        version = package_version()
        if version != self.version:
            yield 'move_base_abstract was {} then, and is {} now'.format(self.version, version)
        for path, digest in self.digests.items():
            now = _digest(path)
            if now != digest:
                yield '{} {}'.format(path, 'has changed since' if now else 'is not there any more')


def of_run(words: List[str], folder: str, environment: Mapping[str, str], paths: Iterable[str],
           program: Sequence[str] = ()) -> Start:
    """Return the Start of a run. ``paths``: those of its launch files and programs."""
    digests = {path: _digest(path) for path in sorted(set(paths))}
    named = [name for path in digests if path.endswith(_LAUNCH_FILES) for name in _names_in(path)]
    return Start(words, folder, {name: environment[name] for name in sorted(environment) if _counts(name, named)},
                 digests, package_version(), list(program))


def _counts(name: str, named: Iterable[str]) -> bool:
    return name in named or _COUNTING.fullmatch(name) is not None and name not in _OF_EACH_RUN


def _names_in(path: str) -> List[str]:
    try:
        with open(path, encoding='utf-8', errors='replace') as stream:
            return _NAMED.findall(stream.read(_PIECE))
    except OSError:
        return []


def _digest(path: str) -> str:
    """Return the SHA-256 of a file, or '' if it cannot be read."""
    try:
        return sha256_of(path)
    except OSError:
        return ''


def write(log: str, start: Start) -> None:
    """Write what starts the run of the event log ``log`` beside it. Only a file of this kind is replaced.

    :raises ConfigurationError: if another file is there.
    :raises OutputError: if it cannot be written.
    """
    path = log + SUFFIX
    check_file(path, lambda line: line.startswith(b'{"run_of_log": '))
    with whole_file(path, encoding='utf-8', errors='surrogateescape') as stream:
        text = json.dumps(start._asdict(), indent=1)
        stream.write('{"run_of_log": %d,%s\n' % (FORMAT, text[1:]))  # the first line identifies the file


def read(log: str) -> Start:
    """Return what started the run of the event log ``log``.

    :raises ConfigurationError: if no file beside it says so; the text says what makes one.
    """
    path = log + SUFFIX
    try:
        content = load_json_mapping(path)
    except FileNotFoundError:
        raise ConfigurationError('{}: is not there; it says what started the run of {}, and lockstep_launch '
                                 '--event-log writes it'.format(path, log)) from None
    if content.get('run_of_log') != FORMAT:
        raise ConfigurationError('{}: must say what started a run, in format {}; got {}'.format(
            path, FORMAT, shown(content.get('run_of_log'))))
    checks: Dict[str, Any] = {'words': _are_texts, 'folder': _is_text, 'environment': _is_table, 'digests': _is_table,
                              'version': _is_text, 'program': _are_texts}
    for key, is_fit in checks.items():
        if not is_fit(content.get(key)):
            raise ConfigurationError('{}: {} must be as lockstep_launch writes it; got {}'.format(
                path, key, shown(content.get(key))))
    return Start(**{key: content[key] for key in checks})


def _is_text(value: Any) -> bool:
    return isinstance(value, str)


def _are_texts(value: Any) -> bool:
    return isinstance(value, list) and all(map(_is_text, value))


def _is_table(value: Any) -> bool:
    return isinstance(value, dict) and all(map(_is_text, value.values()))
