"""What started a run stands beside its event log, and says later what has changed since."""
import pytest

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.runs import run_file


@pytest.fixture
def files(tmp_path):
    (tmp_path / 'system.launch').write_text('<launch><arg name="a" default="$(optenv SIZE 3)"/></launch>')
    (tmp_path / 'node.py').write_text('print()')
    return [str(tmp_path / name) for name in ('system.launch', 'node.py')]


def start(files, **environment):
    return run_file.of_run(['--seed', '3', 'system.launch', 'robots:=2'], '/here', environment, files)


def test_a_start_is_read_as_it_was_written(tmp_path, files):
    written, log = start(files, PATH='/bin', SIZE='5', HOME='/home/me'), str(tmp_path / 'a.jsonl')
    run_file.write(log, written)
    assert run_file.read(log) == written
    assert not list(written.changes())


def test_only_variables_that_count_are_written(files):
    """Those of Python, ROS and the system's programs, and those that a launch file names. Others may be secret."""
    assert start(files, PATH='/bin', SIZE='5', ROS_PACKAGE_PATH='/a', LC_ALL='C', SECRET='x', ROS_MASTER_URI='http://x',
                 ROSE='y').environment == {'LC_ALL': 'C', 'PATH': '/bin', 'ROS_PACKAGE_PATH': '/a', 'SIZE': '5'}


def test_the_environment_is_as_it_was_then(files):
    then = start(files, PATH='/bin', PYTHONPATH='/then')
    now = {'PATH': '/usr/bin', 'PYTHONHASHSEED': '5', 'HOME': '/home/me', 'ROS_LOG_DIR': '/logs'}
    assert then.environment_again(now) == {'PATH': '/bin', 'PYTHONPATH': '/then', 'HOME': '/home/me',
                                           'ROS_LOG_DIR': '/logs'}


def test_what_has_changed_since_is_named(tmp_path, files):
    then = start(files)
    (tmp_path / 'node.py').write_text('print(1)')
    (tmp_path / 'system.launch').unlink()
    assert list(then._replace(version='0.1').changes())[0].startswith('move_base_abstract was 0.1 then')
    assert list(then.changes()) == [f'{files[1]} has changed since', f'{files[0]} is not there any more']


def test_only_a_file_of_this_kind_is_replaced(tmp_path, files):
    log = str(tmp_path / 'a.jsonl')
    run_file.write(log, start(files))
    run_file.write(log, start(files, PATH='/other'))
    assert run_file.read(log).environment == {'PATH': '/other'}
    (tmp_path / 'a.jsonl.run').write_text('mine\n')
    with pytest.raises(ConfigurationError, match='this program did not make it'):
        run_file.write(log, start(files))
    assert (tmp_path / 'a.jsonl.run').read_text() == 'mine\n'


@pytest.mark.parametrize('text, said', [
    ('{"run_of_log": 2}', 'format 1; got 2'), ('[]', 'must be a mapping'), ('{"run_of_log": 1, "words": [1]}', 'words'),
    ('{"run_of_log": 1, "words": [], "folder": "/", "environment": {"A": 1}}', 'environment'), ('x', 'JSON')])
def test_an_odd_file_is_an_error_that_names_it(tmp_path, text, said):
    (tmp_path / 'a.jsonl.run').write_text(text)
    with pytest.raises(ConfigurationError, match=said) as error:
        run_file.read(str(tmp_path / 'a.jsonl'))
    assert 'a.jsonl.run' in str(error.value)


def test_a_missing_file_says_what_writes_it(tmp_path):
    with pytest.raises(ConfigurationError, match='lockstep_launch --event-log writes it'):
        run_file.read(str(tmp_path / 'a.jsonl'))
