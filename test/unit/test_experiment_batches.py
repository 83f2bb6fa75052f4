"""Batches of short trials: how many go together, and that each stays one by itself, whatever becomes of its worker."""
import asyncio
import collections
import contextlib
import copy
import dataclasses
import gc
import io
import json
import os
import pickle
from types import SimpleNamespace

import pytest

from experiment_jobs import job_of
from move_base_abstract_experiments import sweep
from move_base_abstract_experiments.carrying import batches, cluster, jobs, spool
from move_base_abstract_experiments.description.trial import Trial
from move_base_abstract_experiments.trials import run_folders


def jobs_of(count):
    first = job_of()
    return [dataclasses.replace(first, trial=dataclasses.replace(first.trial, id=f'{number:04d}-abcdef', seed=number))
            for number in range(count)]


def batch_of(count):
    return pickle.dumps(jobs_of(count))


@pytest.fixture
def ran(monkeypatch):
    """Stand for the warm process; the list of the seeds of jobs that ran. A job of a seed in ``bad`` leaves nothing."""
    seen = []

    def carry_out(job, target=None):
        seen.append(job.trial.seed)
        content = str(job.trial.seed).encode()
        if target is None:
            return 'w', content, None
        with open(target, 'wb') as stream:
            stream.write(content)
        return 'w', None, None
    monkeypatch.setattr(jobs, 'carry_out', carry_out)
    return seen


def test_as_many_go_together_as_take_a_second_and_all_threads_have_some_left():
    sizes = batches.Sizes()
    assert sizes.size(1000, 2) == 1  # nothing is known yet
    sizes.learn(10, 0.1)
    assert sizes.size(100_000, 2) == 100
    assert [sizes.size(left, 2) for left in (80, 16, 3, 1)] == [10, 2, 1, 1]
    for _ in range(100):
        sizes.learn(10, 100.0)  # later ones are long
    assert sizes.size(100_000, 2) == 1
    assert batches.Sizes().size(10, 0) == 1
    quick = batches.Sizes()
    quick.learn(1, 0.0)
    assert quick.size(10**6, 1) == batches.MOST


def test_what_all_jobs_have_in_common_travels_once():
    many, text = jobs_of(100), 'x' * 10_000
    many = [dataclasses.replace(one, common=many[0].common._replace(sources={'a.py': text})) for one in many[:1]] * 100
    assert len(pickle.dumps(many)) < 2 * len(text)
    assert len(batch_of(100)) < 100 * 200 < len(pickle.dumps(jobs_of(1)[0])) * 100
    assert pickle.loads(batch_of(3)) == jobs_of(3)


def test_a_worker_gives_back_what_it_has_not_begun_in_time(ran, monkeypatch):
    now = iter(range(0, 1000, 2))
    monkeypatch.setattr(batches.time, 'monotonic', lambda: next(now))
    _, count, answers = batches.carry_out(pickle.dumps(jobs_of(10)), None)
    assert (count, ran) == (2, [0, 1])
    assert [batches.Answer(*one).outputs for one in answers] == [b'0', b'1']


def test_a_worker_that_is_to_end_begins_no_more(ran, monkeypatch):
    carry_out = jobs.carry_out

    def ended_meanwhile(*words):
        jobs.end_all()
        return carry_out(*words)
    monkeypatch.setattr(jobs, 'carry_out', ended_meanwhile)
    assert len(batches.carry_out(pickle.dumps(jobs_of(5)), None)[2]) == 1
    assert ran == [0]


def test_what_a_worker_that_died_has_completed_stays_and_the_trial_under_way_is_named(ran, tmp_path):
    notes = spool.Notes(str(tmp_path / 'key'))
    assert notes.begun() is None
    for number in (0, 1):
        notes.begin(number)
        (tmp_path / 'key' / f'{number:04d}.tar').write_bytes(b'by the first')
    notes.begin(2)
    _, count, answers = batches.carry_out(pickle.dumps(jobs_of(5)), notes.path)
    assert (count, ran) == (2, [3, 4])
    assert [batches.Answer(*one).is_lost for one in answers] == [False, False, True, False, False]
    assert [notes.take(number) for number in range(5)] == [b'by the first'] * 2 + [None, b'3', b'4']
    notes.remove(5)
    assert not os.path.exists(notes.path)


class Dask:
    """Stands for a Client: workers run a batch as soon as it is handed over. ``deadly``: seeds of which they die."""

    def __init__(self, deadly=(), tries=3):
        self.deadly = deadly
        self.tries = tries  # of a task whose worker dies
        self.sizes = []
        self.deaths = 0

    def submit(self, function, batch, path, key, **_options):
        self.sizes.append(len(pickle.loads(batch)))
        result = self._result(function, batch, path)
        return SimpleNamespace(key=key, result=lambda timeout: result() if callable(result) else result,
                               release=lambda: None, add_done_callback=lambda tell: tell(SimpleNamespace(key=key)))

    def _result(self, function, batch, path):
        for _ in range(self.tries):
            try:
                return function(batch, path)
            except ConnectionError:
                self.deaths += 1
        return self._raise

    def _raise(self):
        raise RuntimeError('KilledWorker')


def run(monkeypatch, count, deadly=(), shared=None, failing=()):
    """Run so many jobs; return (Dask, {seed: (outputs, problem, attempts)})."""
    done, carry_out = {}, jobs.carry_out

    def dies(job, target=None):
        if job.trial.seed in deadly:
            raise ConnectionError
        return carry_out(job, target)
    monkeypatch.setattr(jobs, 'carry_out', dies)
    watch = SimpleNamespace(spool=shared, look=lambda: 1)
    client = Dask(deadly)

    def take(job, _worker, outputs, problem, attempts):
        assert job.trial.seed not in done
        done[job.trial.seed] = (outputs, problem, attempts)
    runner = cluster.Runner(client, watch, take, lambda _outputs, job: job if job.trial.seed in failing else None,
                            lambda _runner: None, contextlib.nullcontext)
    runner._sizes.learn(100, 10.0)  # ten in a second
    runner.run(jobs_of(count), count)
    return client, done


def test_short_trials_go_in_batches_and_one_that_fails_runs_again_without_the_others(ran, monkeypatch):
    client, done = run(monkeypatch, 60, failing=[3])
    assert max(client.sizes) > 5
    assert len(client.sizes) < 30
    assert collections.Counter(ran) == {**dict.fromkeys(range(60), 1), 3: 2}
    assert {seed: attempts for seed, (_, _, attempts) in done.items()} == {**dict.fromkeys(range(60), 1), 3: 2}
    assert done[7] == (b'7', None, 1)


@pytest.mark.parametrize('has_spool', [True, False])
def test_a_trial_of_which_workers_die_costs_none_of_the_others(ran, monkeypatch, tmp_path, has_spool):
    client, done = run(monkeypatch, 60, [13], str(tmp_path / 'spool') if has_spool else None)
    assert sorted(done) == list(range(60))
    assert 'its workers were lost 9 times' in done[13][1]
    assert {seed: outputs for seed, (outputs, _, _) in done.items()} == {
        **{seed: str(seed).encode() for seed in range(60)}, 13: None}
    if has_spool:  # none that is complete runs again, and it is blamed by its name each time
        assert collections.Counter(ran) == dict.fromkeys(set(range(60)) - {13}, 1)
        assert client.deaths == cluster.LOSSES + 1
        assert os.listdir(tmp_path / 'spool') == []
    else:  # Dask tries a batch, and then the one by itself, that often
        assert client.deaths == client.tries * (1 + cluster.LOSSES + 1)


def test_what_workers_give_back_runs_later(ran, monkeypatch):
    monkeypatch.setattr(batches, 'LONGEST_S', -1.0)
    _, done = run(monkeypatch, 60)
    assert collections.Counter(ran) == dict.fromkeys(range(60), 1)
    assert sorted(done) == list(range(60))


@pytest.fixture
def only_new_objects():
    """The objects of other tests, which are many, are not among those that gc finds."""
    gc.collect()
    gc.freeze()
    yield
    gc.unfreeze()


@pytest.mark.usefixtures('only_new_objects')
def test_nothing_is_kept_of_trials_that_have_ended(ran):
    runner = cluster.Runner(Dask(), SimpleNamespace(spool=None, look=lambda: 1), lambda *_: None, lambda *_: None,
                            lambda _runner: None)

    def kept_after(count):
        """Return how many objects there are after so many trials more."""
        runner.run((dataclasses.replace(job_of(), modules=str(number)) for number in range(count)), count)
        gc.collect()
        return len(gc.get_objects())
    kept_after(10)
    first, second = kept_after(200), kept_after(400)
    assert len(ran) == 610
    assert second - first < 20


@pytest.mark.usefixtures('only_new_objects')
def test_nothing_is_kept_of_trials_that_have_ended_but_what_the_plan_says(monkeypatch, tmp_path):
    (tmp_path / 'model.py').write_text('def run(trial):\n    return {}\n')
    document = tmp_path / 'x.yaml'
    document.write_text('{experiment: x, function: model:run, replications: 50}')
    alive = []

    @contextlib.contextmanager
    def connected(*_):
        yield SimpleNamespace(scheduler_info=dict), SimpleNamespace(known=())

    class Runner:
        def __init__(self, _client, _watch, done, *_):
            self._done = done

        def run(self, all_jobs, _count):
            for job in all_jobs:
                self._done(job, 'w', None, 'it is not run', 1)
                alive.append(sum(isinstance(one, Trial) for one in gc.get_objects()))
    monkeypatch.setattr(sweep.cluster, 'connected', connected)
    monkeypatch.setattr(sweep.cluster, 'Runner', Runner)
    sweep.run(str(document), str(tmp_path / 'out'), 1, 'tcp://nobody', io.StringIO())
    assert len(alive) == 50
    assert alive[0] - alive[-1] == 49
    assert [one['id'][:4] for one in json.loads((tmp_path / 'out' / 'plan.json').read_text())['trials']] == [
        f'{number:04d}' for number in range(1, 51)]


@pytest.mark.parametrize('has_dashboard', [True, False])
def test_workers_keep_profiles_only_for_the_page_that_shows_them(tmp_path, has_dashboard):
    import dask
    from distributed import Worker
    before = copy.deepcopy(dask.config.config)

    async def often_called():
        worker = Worker('tcp://127.0.0.1:9', local_directory=str(tmp_path), nthreads=1)  # which connects to nobody
        return {name for name, one in worker.periodic_callbacks.items() if one.callback_time < 10e3}
    try:
        cluster._configure(dask, has_dashboard)
        found = asyncio.run(often_called())
    finally:
        dask.config.config.clear()
        dask.config.config.update(before)
    assert {'profile', 'profile-cycle', 'monitor'} & found == ({'profile', 'profile-cycle', 'monitor'}
                                                               if has_dashboard else set())
    assert 'heartbeat' in found


def test_a_folder_that_is_as_a_new_one_serves_the_next_trial_and_no_other_does(tmp_path):
    def left_by(do):
        path = tmp_path / do.__name__
        path.mkdir()
        folders = run_folders.make_folders(str(path / 'run'))
        with open(os.path.join(folders.files, 'a'), 'w'), open(os.path.join(folders.logs, 'b'), 'w'), \
                open(os.path.join(folders.own, 'c'), 'w'):
            do(folders)
        return run_folders.empty_again(folders.own), [names for _, _, names in os.walk(folders.own)]

    def nothing(_folders):
        pass

    def empty_prints(folders):
        for folder in folders:
            with open(os.path.join(folder, run_folders.OUTPUT), 'w'):
                pass

    def prints(folders):
        with open(os.path.join(folders.logs, run_folders.OUTPUT), 'w') as stream:
            stream.write('x')

    def a_folder(folders):
        os.mkdir(os.path.join(folders.files, 'd'))

    def another_mode(folders):
        os.chmod(folders.files, 0o700 if os.lstat(folders.own).st_mode & 0o77 else 0o777)

    def a_link(folders):
        os.rename(folders.logs, folders.logs + '_')
        os.symlink(folders.logs + '_', folders.logs)
    assert left_by(nothing) == left_by(prints) == (True, [[], [], []])
    is_new, names = left_by(empty_prints)
    assert (is_new, sorted(names)) == (True, [[], [], [run_folders.OUTPUT]])  # for the next one's
    assert [left_by(do)[0] for do in (a_folder, another_mode, a_link)] == [False] * 3
