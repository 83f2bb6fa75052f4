"""The file that runs a failure again: the launch file or the test, the seed, the decisions, and the failure."""
from __future__ import annotations

import json
import re
from dataclasses import dataclass, field, replace
from typing import Any, Dict, List, Optional

from ..common import options
from ..common.errors import ConfigurationError
from ..common.json_files import load_json_mapping
from ..common.own_files import check_file, whole_file
from ..common.shown import shown
from ..runs import debug_command
from .run_options import ALLOW, FAIL, RunOptions

FORMAT = 3
#: the environment variable with the path of this file for a test that is run again
VARIABLE = 'MOVE_BASE_ABSTRACT_REPLAY'
_DURATIONS = 1  # the format in which `until` is a time from the start, at 1 s
_WITHOUT_STARTS = 2
_NAME = re.compile('[0-9a-f]{12}')


@dataclass
class Replay:
    """One failing run."""

    launch: List[str]  # a path, then ARG:=VALUE words; of a test: []
    seed: int  # of chaos; 0: the stated order
    delay: float  # the largest delay of messages [s, simulated]
    only: List[str]  # the names of the decisions
    failure: str  # the name of the Failure
    text: str  # its text
    document: Dict[str, Any] = field(default_factory=dict)  # other options of the run, as keys of a file
    happened: List[str] = field(default_factory=list)  # the decisions in words
    sha256: str = ''  # the digest of the event log
    test: List[str] = field(default_factory=list)  # the folder in which pytest was started, and the test's id
    starts: float = 0.0  # the largest lateness of a node's start [s, simulated]
    count: Dict[str, Any] = field(default_factory=dict)  # the fields of a Count of chaos; {}: no seeds were counted
    debug: str = ''  # the command that leads to before the failure in the debugger; it is for people

    @property
    def run(self) -> RunOptions:
        """The options of this run. Crashes and broken properties are allowed, and so compared.

        :raises ConfigurationError: if they are not valid.
        """
        chaos = {'chaos_seed': self.seed, 'chaos_delay': self.delay, 'chaos_starts': self.starts,
                 'chaos_only': self.only or ['none']}
        return options.read(RunOptions, '', {**self.document, 'crashes': ALLOW, 'properties': [],
                                             **(chaos if self.seed else {})})

    def debug_command(self, instant_ns: Optional[int]) -> str:
        """Return the command that leads to before a failure at this instant [ns, None: unknown] in the debugger."""
        asked = replace(self.run, crashes=FAIL)
        return debug_command.of_run(['--end-when-idle', *options.words_of(asked), *self.launch], [instant_ns])


def said(decision: Dict[str, Any]) -> str:
    """Return a decision in words: "/b's message on /x reached /a before /c's message on /y, at 41.3 s"."""
    return f"{decision['says']}, at {decision['time_ns'] * 1e-9:.9g} s"


def write(path: str, replay: Replay) -> None:
    """Write a Replay as a whole file. It replaces only a file that `chaos` has written.

    :raises OutputError, ConfigurationError: if it cannot be written, or another file is there.
    """
    check_file(path, lambda start: start.startswith(b'{"chaos": '))
    with whole_file(path, encoding='utf-8') as stream:
        text = json.dumps(vars(replay), indent=1)
        stream.write('{"chaos": %d,%s\n' % (FORMAT, text[1:]))  # the first line identifies the file


def read(path: str) -> Replay:
    """Return the Replay in a file. :raises ConfigurationError: naming the file, what is wrong and what is allowed."""
    try:
        content = load_json_mapping(path)
    except FileNotFoundError:
        raise ConfigurationError(f'{path}: is not there') from None
    if content.get('chaos') not in (FORMAT, _WITHOUT_STARTS, _DURATIONS):
        raise ConfigurationError(f"{path}: is not a file of chaos of format {FORMAT}; got "
                                 f"{shown(content.get('chaos'))}")
    content = {'test': [], 'starts': 0.0, 'count': {}, 'debug': '', **content}  # files of earlier releases have none
    fields: Dict[str, Any] = {
        'launch': list, 'seed': int, 'delay': (int, float), 'only': list, 'failure': str, 'text': str,
        'document': dict, 'happened': list, 'sha256': str, 'test': list, 'starts': (int, float), 'count': dict,
        'debug': str}
    for key, kind in fields.items():
        if not isinstance(content.get(key), kind) or isinstance(content[key], bool):
            raise ConfigurationError(f'{path}: {key} must be as `chaos` writes it; got {shown(content.get(key))}')
    for key in ('launch', 'only', 'happened', 'test'):
        if not all(isinstance(one, str) for one in content[key]):
            raise ConfigurationError(f'{path}: {key} must be a list of texts; got {shown(content[key])}')
    test = content['test']
    if test and len(test) != 2:
        raise ConfigurationError(f'{path}: test must be a folder and the id of a test; got {shown(test)}')
    if not (content['launch'] or test) or not all(map(_NAME.fullmatch, content['only'])):
        raise ConfigurationError(f'{path}: launch must name a file, and only must be names of decisions')
    found = Replay(**{key: content[key] for key in fields})
    if content['chaos'] == _DURATIONS and 'until' in found.document:
        found.document['until'] += 1.0
    assert found.run  # checks the options
    return found
