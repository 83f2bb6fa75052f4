"""What the tests of systems share: an environment of their own, a launch file, and the output of nodes if a test fails.

Each file runs in a process of its own (`make test`, or `python3 -m pytest FILE`), since a process can be one node only.
"""
import atexit
import os
import shutil
import sys
import tempfile
from pathlib import Path

import pytest

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, os.path.dirname(HERE)]
NO_MASTER = 'http://127.0.0.1:1/'  # no program can listen there: what a test does not start itself, it must not find
TAIL_LINES = 15


def pytest_configure(config):
    """Give the process an environment in which it meets no other ROS, and a folder for all that nodes print."""
    for name in ('ROS_HOSTNAME', 'ROS_NAMESPACE'):
        os.environ.pop(name, None)
    config.systems_folder = tempfile.mkdtemp(prefix='systems_')
    os.mkdir(os.path.join(config.systems_folder, 'ros'))
    os.environ.update(ROS_MASTER_URI=NO_MASTER, ROS_IP='127.0.0.1', PYTHONUNBUFFERED='1',
                      TMPDIR=config.systems_folder, ROS_HOME=os.path.join(config.systems_folder, 'ros'),
                      ROS_LOG_DIR=os.path.join(config.systems_folder, 'ros', 'log'))
    tempfile.tempdir = config.systems_folder
    # What is registered first is called last: after genpy and others have removed their folders in it.
    atexit.register(_remove, config.systems_folder, os.getpid())


def _remove(folder, pid):
    if os.getpid() == pid:  # not in a child that was forked
        shutil.rmtree(folder, ignore_errors=True)


def pytest_collection_modifyitems(items):
    """Refuse two files that are nodes in one process."""
    nodes = sorted({item.module.__name__ for item in items if getattr(item.module, 'OWN_NODE', None)})
    if len(nodes) > 1:
        raise pytest.UsageError('{}: each of these files is a ROS node, and a process can be only one; give pytest one '
                                'of them, or use `make test ONLY=...`'.format(', '.join(nodes)))


@pytest.fixture(scope='module', autouse=True)
def launch_of_the_file(request):
    """Start the file's LAUNCH_FILE before its first test, and end it after its last one."""
    text = getattr(request.module, 'LAUNCH_FILE', None)
    if text is None:
        yield None
        return
    from launched import launched
    with launched(text, *(getattr(request.module, name, None) for name in ('OWN_NODE', 'FACTOR'))) as ros:
        yield ros


@pytest.fixture(scope='module', autouse=True)
def runs_of_the_file(request):
    """End the ROS master that the file's RUNS may share, after its last test."""
    yield
    close = getattr(getattr(request.module, 'RUNS', None), 'close', None)
    if close is not None:
        close()


def pytest_terminal_summary(terminalreporter, config):
    """Show the last lines that each process has printed, if a test has failed."""
    if not terminalreporter.stats.get('failed') and not terminalreporter.stats.get('error'):
        return
    for path in sorted(Path(config.systems_folder).rglob('*.out')):
        lines = path.read_text(errors='replace').splitlines()[-TAIL_LINES:]
        if lines:
            terminalreporter.section(str(path.relative_to(config.systems_folder)), sep='-')
            terminalreporter.write_line('\n'.join(lines))
