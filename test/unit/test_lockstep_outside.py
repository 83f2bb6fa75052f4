"""Threads that wait for somebody outside: after how long time goes on, and what the label says."""
import io
import os
import subprocess
import sys
import threading
from types import SimpleNamespace

import pytest

from move_base_abstract_ros.lockstep.waiting import outside


@pytest.fixture
def look(monkeypatch):
    """Give a function look(at) that returns what is told by then [s] of a thread that reads from a pipe."""
    told, (reader, writer) = [], os.pipe()
    thread = threading.Thread(target=lambda: os.read(reader, 1))
    thread.start()
    scheduler = SimpleNamespace(turn_ident=thread.ident, let_go=lambda _ident, still_waits: still_waits())
    monkeypatch.setattr(outside, 'told', SimpleNamespace(tell_place=lambda _place, what, why: told.append((what, why))))
    one = outside.Outside(scheduler)
    while one._waits_of(thread.ident) is None:
        pass

    def look_at(at):
        one.look(at)
        return told
    yield look_at
    os.write(writer, b'x')
    thread.join()


def test_after_5_s_time_goes_on_and_then_after_less_and_it_is_told_once(look):
    assert look(0.0) == look(4.9) == []
    (what, why), = look(5.0)
    assert 'os.read(reader, 1)' in what and 'longer than 5 s' in why
    assert len(look(6.0)) == len(look(7.0)) == 1


def test_beside_a_process_of_the_program_it_is_60_s(look):
    with subprocess.Popen([sys.executable, '-c', 'input()'], stdin=subprocess.PIPE):
        assert look(0.0) == look(59.9) == []
        assert 'longer than 60 s' in look(60.0)[0][1]


def test_who_prints_waits_for_a_reader_and_for_nobody_else(monkeypatch):
    monkeypatch.setattr(sys, 'stderr', io.StringIO())  # a program's own, without a number
    reader, writer = os.pipe()
    os.set_blocking(writer, False)
    with pytest.raises(BlockingIOError):
        while True:
            os.write(writer, b'x' * 4096)
    os.set_blocking(writer, True)
    thread = threading.Thread(target=os.write, args=(writer, b'x'))
    thread.start()
    one = outside.Outside(SimpleNamespace())
    while one._waits_of(thread.ident) is None:
        pass
    os.read(reader, 65536)
    thread.join()
