"""A test that the program `debug` runs: it starts this package as a program, and the test starts its run stopped."""
from __future__ import annotations

import argparse
import json
import os
import sys
from typing import Any, Dict, NamedTuple, Optional

from move_base_abstract_ros import debugging

#: the words that begin the command of a test that is debugged
PROGRAM = (sys.executable, '-m', 'move_base_abstract_testing')
_VARIABLE = 'MOVE_BASE_ABSTRACT_DEBUGGED_TEST'


class Debugged(NamedTuple):
    """What `debug` wants of a run: the folder of ``notes`` about it, and the path of its event ``log``."""

    notes: str
    log: str

    @property
    def parameters(self) -> Dict[str, Any]:
        """Parameters of the time master."""
        return {**debugging.PARAMETERS, 'event_log': self.log}


def asked() -> Optional[Debugged]:
    """Return what `debug` wants of the test in this process, or None if nobody debugs it."""
    text = os.environ.get(_VARIABLE)
    return Debugged(*json.loads(text)) if text else None


def main() -> None:
    """Become pytest with the test of the command line, for `debug`."""
    parser = argparse.ArgumentParser(prog='move_base_abstract_testing', allow_abbrev=False)
    parser.add_argument('--debugged', action='store_true', required=True)
    for name in ('--notes', '--event-log'):
        parser.add_argument(name, required=True)
    parser.add_argument('test')
    options = parser.parse_args()
    os.environ[_VARIABLE] = json.dumps([options.notes, options.event_log])
    os.execv(sys.executable, [sys.executable, '-m', 'pytest', '-q', '-p', 'move_base_abstract_testing', options.test])
