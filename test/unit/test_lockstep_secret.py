"""The secret of a run: where it is read from, and what is refused."""
import os

import pytest

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.lockstep.secret import LONGEST, run_secret


@pytest.fixture
def secret_file(tmp_path):
    """Return a function that writes a file of this content and mode, and returns its path."""
    def write(content, mode=0o600):
        path = tmp_path / 'secret'
        path.write_bytes(content)
        path.chmod(mode)
        return str(path)
    return write


def test_there_need_not_be_one():
    assert run_secret('', '') == b''


def test_it_is_a_text_or_what_a_file_has_without_space_around(secret_file):
    assert run_secret(' Zürich\n', '') == 'Zürich'.encode()
    assert run_secret('', secret_file(b' a b\xff\r\n')) == b'a b\xff'
    assert run_secret('', secret_file(b'x' * LONGEST + b'\n')) == b'x' * LONGEST


@pytest.mark.parametrize('mode', [0o640, 0o604, 0o620, 0o601])
def test_a_file_that_others_may_use_is_refused(secret_file, mode):
    with pytest.raises(ConfigurationError, match='lockstep_secret_file.*others may use it too; chmod 600'):
        run_secret('', secret_file(b'abc', mode))


def test_what_is_no_secret_is_refused(secret_file, tmp_path):
    pipe = str(tmp_path / 'pipe')
    os.mkfifo(pipe, 0o600)
    for text, path, words in (('a', 'b', 'both are set'), (' ', '', 'lockstep_secret: got none'),
                              (7, '', 'got 7; allowed: a text'), ('x' * 1025, '', 'got more; allowed: 1 to 1024 bytes'),
                              ('', str(tmp_path / 'none'), 'No such file'), ('', str(tmp_path), 'Is a directory'),
                              ('', pipe, 'no ordinary file'), ('', 'a\0b', 'null')):
        with pytest.raises(ConfigurationError, match=words):
            run_secret(text, path)
    for content, words in ((b' \n', 'secret_file: got none'), (b'x' * 1025, 'secret_file: got more')):
        with pytest.raises(ConfigurationError, match=words):
            run_secret('', secret_file(content))
