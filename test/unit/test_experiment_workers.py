"""Workers that fall silent: they are ended, others are asked for, and without any the sweep ends."""
import json
import os
import signal
import subprocess
import sys
from functools import partial
from types import SimpleNamespace

import pytest

from move_base_abstract_experiments import command, sweep
from move_base_abstract_experiments.carrying import workers
from move_base_abstract_experiments.results import outputs


class Client:
    """Stands for Dask's: what its scheduler knows."""

    def __init__(self):
        self.known = {}
        self.processing = {}
        self.takes_s = 0.0
        self.now = 0.0
        self.scheduler = SimpleNamespace(identity='identity', processing='processing')

    def sync(self, what, callback_timeout, **_others):
        self.now += self.takes_s / 2
        return {'workers': {key: dict(value) for key, value in self.known.items()}} if what == 'identity' else (
            self.processing)

    def hear(self, address, pid=None):
        self.known[address] = {'name': address, 'nthreads': 1, 'last_seen': self.now}


def looks(watch, client, seconds, step=0.5, heard=()):
    for _ in range(int(seconds / step)):
        client.now += step
        for address in heard:
            client.hear(address)
        threads = watch.look()
    return threads


@pytest.fixture
def process():
    child = subprocess.Popen([sys.executable, '-c', 'import time; time.sleep(1000)'])
    yield child
    child.kill()
    child.wait()


def test_a_worker_here_that_is_stopped_is_ended_and_another_asked_for(process):
    client = Client()
    asked = []
    own = SimpleNamespace(workers={0: SimpleNamespace(worker_address='a', pid=process.pid)}, scale=asked.append)
    watch = workers.Workers(client, own, 2, clock=lambda: client.now)
    os.kill(process.pid, signal.SIGSTOP)
    client.hear('a')
    client.processing = {'a': (workers.key_of(1, ['0001-abcdef']), workers.key_of(2, ['0002-abcdef', '0003-abcdef']),
                               "somebody's")}
    assert looks(watch, client, 15.0) == 1
    assert watch.known[0][:2] == (f'a (process {process.pid})', ('0001-abcdef', '0002-abcdef and 1 more', "somebody's"))
    assert process.poll() is None
    assert looks(watch, client, 10.0) == 0
    assert process.wait() == -signal.SIGKILL
    assert set(asked) == {2}


def test_a_worker_that_is_heard_stays_and_a_computer_that_slept_has_no_silent_ones(process):
    client = Client()
    own = SimpleNamespace(workers={0: SimpleNamespace(worker_address='a', pid=process.pid)}, scale=lambda _count: None)
    watch = workers.Workers(client, own, 1, clock=lambda: client.now)
    assert looks(watch, client, 100.0, heard=['a']) == 1
    client.now += 10_000.0
    assert looks(watch, client, 5.0) == 1
    assert looks(watch, client, 5.0, heard=['a']) == 1
    assert process.poll() is None


@pytest.mark.parametrize('takes_s', [0.0, 20.0])
def test_without_any_worker_a_sweep_ends_within_a_minute(takes_s):
    client = Client()
    client.takes_s = takes_s  # a scheduler that answers late, or not
    watch = workers.Workers(client, None, 1, clock=lambda: client.now)
    with pytest.raises(workers.NoWorkerError, match='no worker has been heard for 60 s'):
        looks(watch, client, 200.0)
    assert 55.0 < client.now < 85.0


def test_one_silent_worker_of_others_ends_no_sweep():
    client = Client()
    watch = workers.Workers(client, None, 1, clock=lambda: client.now)
    client.hear('silent')
    assert looks(watch, client, 200.0, heard=['a']) == 1
    assert [one.name for one in watch.known if one.silent_s > 100] == ['silent (silent)']


def test_status_has_a_line_for_each_worker(tmp_path, capsys):
    with outputs.OutputFolder(tmp_path / 'out') as folder:
        folder.write('plan.json', json.dumps({'format': 1, 'experiment': 'e'}).encode())
        with workers.workers_file(folder) as tell:
            tell([workers.Worker('0 (process 7)', ('0001-abcdef',), 0.2), workers.Worker('1', (), 33.0)])
            command.main(['status', str(folder.path)])
            said = capsys.readouterr().out.splitlines()
            assert said[1].startswith('2 workers, as told ')
            assert said[2:] == ['  0 (process 7): 0001-abcdef', '  1: waits for a trial; not heard for 33 s']
        command.main(['status', str(folder.path)])
        assert 'workers' not in capsys.readouterr().out
        assert list(workers.lines(folder.path, 1e12)) == []
        for text in (b'', b'{}', b'{"told_at": 1, "workers": 2}', b'{"told_at": [], "workers": [1]}',
                     b'{"told_at": 1, "workers": [[], {}, {"name": [], "trials": 7, "silent_s": "x"}]}'):
            folder.write(workers.FILE, text)
            assert command.main(['status', str(folder.path)]) == command.GOOD


@pytest.mark.parametrize('number', [signal.SIGTERM, signal.SIGHUP])
def test_a_signal_that_ends_programs_ends_it_as_ctrl_c_does(monkeypatch, capsys, request, number):
    request.addfinalizer(partial(signal.signal, number, signal.signal(number, signal.SIG_DFL)))  # nohup ignores one

    def run(*_words, **_options):
        os.kill(os.getpid(), number)
        signal.pause()
    monkeypatch.setattr(sweep, 'run', run)
    assert command.main(['run', 'x.yaml', '-o', 'out']) == command.INTERRUPTED
    assert 'interrupted; complete trials stay' in capsys.readouterr().err
    assert signal.getsignal(number) == signal.SIG_DFL
