"""A process that somebody else has put on one core: what it starts and what it sees have its own cores."""
import os
import subprocess
import sys
import threading

import pytest

from move_base_abstract.lockstep.own_cores import OwnCores

COUNT = [sys.executable, '-c', 'import os; print(len(os.sched_getaffinity(0)))']


@pytest.fixture(name='own_cores')
def known():
    """Return what knows the process's own cores."""
    cores = OwnCores()
    cores.remember()
    return cores


@pytest.fixture
def bound(own_cores):
    """Yield the process's own cores, of which it has been put on one."""
    own = os.sched_getaffinity(0)
    if len(own) < 2:
        pytest.skip('this computer lets the tests use one core only')
    os.sched_setaffinity(0, {max(own)})
    yield own
    os.sched_setaffinity(0, own)


def started():
    return int(subprocess.run(COUNT, stdout=subprocess.PIPE, check=True).stdout)


def test_what_is_started_has_the_own_cores_and_the_thread_goes_on_where_it_was(bound, own_cores):
    assert started() == 1
    with own_cores.lifted():
        assert started() == len(bound)
    assert os.sched_getaffinity(0) == {max(bound)}


def test_who_asks_sees_the_own_cores(bound, own_cores):
    assert own_cores.seen(os.sched_getaffinity)(0) == bound


def test_all_threads_get_their_cores_back_but_one_that_has_others(bound, own_cores):
    masks, go_on, ready = {}, threading.Event(), threading.Barrier(3)

    def work(name, mask):
        os.sched_setaffinity(0, mask)
        ready.wait()
        go_on.wait()
        masks[name] = os.sched_getaffinity(0)
    threads = [threading.Thread(target=work, args=one) for one in (('bound', {max(bound)}), ('other', {min(bound)}))]
    for thread in threads:
        thread.start()
    ready.wait()
    own_cores.restore()
    go_on.set()
    for thread in threads:
        thread.join()
    assert masks == {'bound': bound, 'other': {min(bound)}}
    assert os.sched_getaffinity(0) == bound


def test_what_the_program_chooses_itself_is_left_to_it(bound, own_cores):
    own_cores.chosen(os.sched_setaffinity)(0, {min(bound)})
    assert own_cores.seen(os.sched_getaffinity)(0) == {min(bound)}
    own_cores.restore()
    assert os.sched_getaffinity(0) == {min(bound)}


def test_libraries_are_loaded_with_the_own_cores(bound, own_cores):
    assert own_cores.loading(lambda: os.sched_getaffinity(0))() == bound
