"""The warm process of a worker: for whom it stays, and what it may say."""
import socket
import subprocess
import sys

import pytest

from experiment_jobs import FUNCTION, job_of
from move_base_abstract_experiments.carrying import jobs
from move_base_abstract_experiments.description import spec

SERVER = """#!{}
import socket, sys
own = socket.socket(fileno=int(sys.argv[-1]))
if '{}' == 'dies':
    sys.exit('this is why')
own.sendall(b'ready\\n')
sys.stderr.write('x' * 300000)  # more than a pipe holds
sys.stderr.write('the last words')
sys.stderr.flush()
own.recv(1 << 20)
"""


@pytest.fixture
def server(tmp_path, monkeypatch):
    """Have a program of the test's be the warm process; give what makes it."""
    def make(how):
        path = tmp_path / 'python'
        path.write_text(SERVER.format(sys.executable, how))
        path.chmod(0o755)
        monkeypatch.setattr(jobs, '_python', lambda _nodes: str(path))
        return jobs.WarmProcess
    monkeypatch.setattr('move_base_abstract_ros.loopback.find_executable', lambda _name: '')
    return make


def test_a_warm_process_that_does_not_start_says_why(server):
    with pytest.raises(jobs.WorkerError, match='did not start: this is why'):
        server('dies')()


def test_what_is_said_stops_no_warm_process_and_is_told_when_it_has_gone(server):
    warm = server('speaks')()
    with pytest.raises(jobs.WorkerError, match='has gone: x*the last words'):
        warm.run(job_of())
    warm.close()


@pytest.fixture
def hasty():
    """Have all new sockets of this process give up soon, as a program can have it, and rospy does after 60 s."""
    socket.setdefaulttimeout(0.01)
    yield
    socket.setdefaulttimeout(None)


def test_time_limits_of_a_process_for_its_sockets_are_not_those_of_the_warm_process(hasty):
    warm = jobs.WarmProcess(wanted=())
    try:
        with pytest.raises(subprocess.TimeoutExpired):
            warm._process.wait(0.3)  # before its cure, it ended because nothing was asked for at once
    finally:
        warm.close()


class Warm:
    """Stands for a warm process."""

    made = []

    def __init__(self, wanted):
        self.wanted = wanted
        self.is_closed = False
        self.made.append(self)

    def run(self, job, target=None):
        return job.trial.id

    def close(self):
        self.is_closed = True


@pytest.mark.parametrize('text, system, warm', [
    ('import random\nfrom helper import half', {}, ()), ('import helper_of_arrays', {}, ('numpy',)),
    ('import scipy.stats', {}, ('numpy',)), ('def run(trial):\n    import rospy', {}, ('ros', 'numpy')),
    ('from move_base_abstract_experiments.carrying import warm_loopback', {}, ('ros', 'numpy')),
    ('import random', {'metrics': 'helper_of_arrays:summarise'}, ('numpy',)),
    ('', {'function': None, 'launch': 'a.launch'}, ('ros', 'numpy'))])
def test_a_warm_process_has_imported_what_trials_may_use_and_no_more(tmp_path, text, system, warm):
    (tmp_path / 'model.py').write_text(text)
    (tmp_path / 'helper.py').write_text('import json\n')
    (tmp_path / 'helper_of_arrays.py').write_text('import numpy\n')
    document = {key: value for key, value in {**FUNCTION, **system}.items() if value}
    assert jobs.common_of(spec.checked(document, str(tmp_path))).warm == warm


def test_what_was_prepared_in_another_way_is_prepared_anew(monkeypatch):
    monkeypatch.setattr(jobs, 'WarmProcess', Warm)
    monkeypatch.setattr(jobs, '_state', jobs.threading.local())
    prepared = {'prepare': 'model:prepare', 'args': {'n': 1}}
    others = {'prepare': 'model:prepare', 'args': {'n': 2}}
    wanted = [({}, {}), ({}, {'a.py': '1'}), (prepared, {'a.py': '1'}), (prepared, {'a.py': '1'}),
              (prepared, {'a.py': '2'}), (others, {'a.py': '2'}), ({}, {})]
    counts = []
    for number, (prepare, sources) in enumerate(wanted):
        assert jobs.carry_out(job_of({**FUNCTION, **prepare}, sources=sources, id=number))[1] == number
        counts.append(len(Warm.made))
    assert counts == [1, 1, 2, 2, 3, 4, 5]
    assert [one.is_closed for one in Warm.made] == [True] * 4 + [False]
    jobs.end_all()
    assert Warm.made[-1].is_closed
