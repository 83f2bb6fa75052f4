"""Frames of lockstep in tracebacks of a program."""
import sys
import threading
import traceback

import pytest

from move_base_abstract_ros.lockstep.failing import tracebacks
from move_base_abstract_ros.replacing.replaced import replaced

OURS = tracebacks._OURS[0] + 'waiting/waits.py'
CALLS = """def call(function, *args):
    return function(*args)
def fails():
    raise ValueError('ours')
"""


@pytest.fixture
def ours():
    """Give the functions of a file of lockstep."""
    names = {}
    exec(compile(CALLS, OURS, 'exec'), names)
    with replaced('traceback.TracebackException.__init__', tracebacks._formatting):
        yield names


def program(ours):
    try:
        ours['call'](ours['fails'])
    except ValueError:
        ours['call'](int, 'many')


def error_of(ours):
    with pytest.raises(ValueError, match='many') as caught:
        ours['call'](program, ours)
    return caught.value


def shown(error):
    return ''.join(traceback.format_exception(type(error), error, error.__traceback__))


def test_texts_of_errors_and_of_what_led_to_them_have_only_lines_of_the_program(ours, monkeypatch):
    error = error_of(ours)
    assert OURS not in shown(error)
    assert shown(error).count('in program') == 2 and 'ValueError: ours' in shown(error)
    monkeypatch.setenv('MOVE_BASE_ABSTRACT_TRACEBACKS', 'all')
    assert shown(error).count(OURS) == 4


def test_what_python_itself_shows_has_only_these_too(ours, capfd):
    error = error_of(ours)
    tracebacks.hide_ours(error)
    sys.__excepthook__(type(error), error, error.__traceback__)
    text = capfd.readouterr().err
    assert OURS not in text and text.count('in program') == 2


def test_an_error_of_lockstep_alone_is_shown_whole(ours, capsys):
    def fails():
        try:
            ours['fails']()
        except ValueError as error:
            errors.append(error.with_traceback(error.__traceback__.tb_next))
    errors = []
    thread = threading.Thread(target=fails)
    thread.start()
    thread.join()
    assert shown(errors[0]).count(OURS) == 1
    errors[0].__context__ = errors[0].__cause__ = errors[0]
    tracebacks.hide_ours(errors[0])
