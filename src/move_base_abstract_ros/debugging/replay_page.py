"""The replay page of a debugged run, so far, at the present instant. It is made by the program `replay`."""
from __future__ import annotations

import os
import pathlib
import subprocess
import webbrowser

from move_base_abstract.common.own_files import PART
from move_base_abstract.runs.debug_command import seconds

from ..loopback import find_executable
from .stops import Refused


def open_page(log: str, folder: str, instant_ns: int) -> str:
    """Make the page of an event log, or of its part, in ``folder``; return its address at an instant [ns].

    If there is a screen, open it in the user's browser.

    :raises Refused: if it cannot be made.
    """
    path = os.path.join(folder, 'replay.html')
    done = subprocess.run([find_executable('replay'), log if os.path.exists(log) else log + PART, '-o', path],
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          errors='backslashreplace', check=False)
    if done.returncode:
        raise Refused('the page cannot be made: {}'.format(done.stdout.strip()))
    address = '{}#t={}'.format(pathlib.Path(path).as_uri(), seconds(instant_ns))
    if os.environ.get('DISPLAY') or os.environ.get('WAYLAND_DISPLAY'):
        webbrowser.open(address)
    return address
