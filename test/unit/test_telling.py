"""How a program ends: on an error of ours or of others, and by its exit code."""
import sys

import pytest

from move_base_abstract.common.errors import ConfigurationError, exit_code_of, telling


@pytest.mark.parametrize(('error', 'others'), [
    (ConfigurationError('bad \udcff'), ()), (OSError('bad \udcff'), (OSError,))])
def test_an_error_is_one_line_in_the_name_of_the_program_whatever_it_holds(error, others, capfd):
    with pytest.raises(SystemExit) as ended, telling('tool', *others, code=3):
        raise error
    assert ended.value.code == 3
    assert capfd.readouterr().err == 'tool: bad \\udcff\n'


def test_another_error_stays():
    with pytest.raises(OSError, match='bad'), telling('tool'):
        raise OSError('bad')


@pytest.mark.parametrize(('code', 'expected'), [(None, 0), (7, 7), ('why', 1)])
def test_the_exit_code_of_a_program_is_that_of_its_end(code, expected, capsys):
    assert exit_code_of(lambda: sys.exit(code)) == expected
    assert capsys.readouterr().err == ('why\n' if code == 'why' else '')
    assert exit_code_of(lambda: None) == 0
