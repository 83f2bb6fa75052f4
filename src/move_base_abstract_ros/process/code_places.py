"""Places in binaries, as preloaded libraries tell them: file + offset, with the line of the source."""
from __future__ import annotations

import os
import re
import shutil
import subprocess
from functools import lru_cache
from typing import Tuple

_PLACE = re.compile(r'([^\s(]+)\+(0x[0-9a-f]+)')
_SECONDS = 10.0  # wall


def with_lines(text: str) -> str:
    """Return a text with ``FILE:LINE`` after each place in it: ``agent+0x12ab (agent.cpp:34)``.

    If the binary has no lines (``-g``), the name of the function is there, unless the binary has no names either. This
    needs addr2line, of binutils.
    """
    return _PLACE.sub(lambda found: found.group() + _source(*found.groups()), text)


@lru_cache(maxsize=1024)
def _source(path: str, offset: str) -> str:
    function, line = _asked(path, offset)
    words = f'{line}, in {function}' if line and function else line or function and f'in {function}'
    return f' ({words})' if words else ''


def _asked(path: str, offset: str) -> Tuple[str, str]:
    """Return (function, FILE:LINE); '' for what is not known."""
    program = shutil.which('addr2line')
    if program is None or not os.path.isfile(path):
        return '', ''
    try:
        done = subprocess.run([program, '-Cfe', path, offset], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                              check=False, timeout=_SECONDS)
    except (OSError, subprocess.TimeoutExpired):
        return '', ''
    function, line = (done.stdout.decode(errors='replace').splitlines() + ['', ''])[:2]
    return '' if function == '??' else function, '' if line.startswith('??') else line.split(' (')[0]
