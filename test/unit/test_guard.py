"""A program and its guard, of which one is ended by a signal: who says why, and that nothing is left."""
import os
import signal
import subprocess
import sys

import pytest

PROGRAM = """
import os, signal
from move_base_abstract.common import guard, temporary
guard.stand('x')
temporary.make('left_')
program = os.getpid()
if os.fork() == 0:
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    signal.alarm(60)  # if nobody ends it
    print(program, guard.has_lost(), flush=True)
while True:
    signal.pause()
"""
LOST, KILLED, TERM, HUP = 'its guard has ended; it ends', 'was ended by SIGKILL', 'ended by SIGTERM', 'ended by SIGHUP'


@pytest.mark.parametrize('before, to_guard, to_program, code, said', [
    ((), [signal.SIGKILL], [], -signal.SIGKILL, LOST),
    ((), [], [signal.SIGKILL], 1, KILLED),
    ((), [signal.SIGTERM], [], 128 + signal.SIGTERM, TERM),
    ((), [signal.SIGHUP], [], 128 + signal.SIGHUP, HUP),
    (('nohup',), [signal.SIGHUP, signal.SIGTERM], [signal.SIGHUP], 128 + signal.SIGTERM, TERM)])
def test_who_is_left_says_why_and_clears(tmp_path, before, to_guard, to_program, code, said):
    guard = subprocess.Popen([*before, sys.executable, '-c', PROGRAM], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                             stdin=subprocess.DEVNULL, text=True, env={**os.environ, 'TMPDIR': str(tmp_path)})
    program, has_lost = guard.stdout.readline().split()
    for number in to_program:
        os.kill(int(program), number)
    for number in to_guard:
        guard.send_signal(number)
    lines = guard.communicate()[0].splitlines()  # until the fork has ended, too
    assert (guard.returncode, len(lines), has_lost) == (code, 1, 'False'), lines
    assert lines[0].startswith('x: ') and said in lines[0]
    assert not os.listdir(tmp_path)
