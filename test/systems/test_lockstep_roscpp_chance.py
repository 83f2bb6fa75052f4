"""Time and chance for unmodified roscpp programs come from the run, from loading on, or are labelled by name."""

import errno
import json
import os
import re
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

from lockstep_roscpp_run import Program, Runs, own, recorder

from move_base_abstract_ros.launching import bags
from move_base_abstract_ros.lockstep.programs.binary import find_shim
from move_base_abstract_ros.loopback import find_executable

RUNS = Runs()
SECOND = 10 ** 9
EPOCH = 1577836800 * SECOND  # 2020-01-01, for seed 0
UPTIME = 3600 * SECOND
WALL_LOOP, READS = (os.path.join(os.path.dirname(os.path.abspath(__file__)), 'unmodified', name)
                    for name in ('wall_loop.py', 'shares.py'))
LAYOUT = 'MOVE_BASE_ABSTRACT_ADDRESS_LAYOUT'


def chance(what, *arguments, name='chance', options=(), **parameters):
    return Program(name, own('shim_chance'), *arguments, options=options, what=what, **parameters)


def rate():
    return Program('rate', own('shim_rate'), frequency=10.0, ticks=30)


class LockstepRoscppChanceTest(unittest.TestCase):

    def told(self, *programs, labels=()):
        """Return the messages of the first program, [(ns, text), ...]."""
        return self.told_in(RUNS.run([*programs, recorder('/told')]), labels)

    def told_in(self, run, labels=()):
        self.assertEqual(run.code, 0, run.outputs)
        self.assertEqual(run.labels, list(labels))
        return [(int(at), text) for at, _topic, text in (line.split(' ', 2) for line in run.printed(-1))]

    def texts(self, *programs, **options):
        return [text for _at, text in self.told(*programs, **options)]

    def test_a_foreign_agent_does_the_same_in_each_run(self):
        programs = [chance('agent'), rate(), recorder('/told')]
        first, *others = map(self.told_in, [*RUNS.scenario(programs), RUNS.run(programs)])
        self.assertEqual(len([text for _at, text in first if text.startswith('loop ')]), 60)
        self.assertGreater(len([text for _at, text in first if text.startswith('rolls ')]), 10)
        for other in others:
            self.assertEqual(other, first)

    def test_computing_takes_no_time_by_any_clock(self):
        rolls = [text.split() for text in self.texts(chance('agent'), rate()) if text.startswith('rolls ')]
        self.assertEqual({words[3] for words in rolls}, {'0'})

    def test_clocks_go_by_simulated_time_and_a_date_of_the_seed(self):
        first, _chance, second, now = self.texts(chance('agent'), rate())[:4]
        for clocks in (first, second[:len(first)]):  # before main(), and in it
            self.assert_clocks(clocks, 0)
        self.assert_clocks(now, 3 * SECOND // 2)
        seed_7 = self.texts(chance('agent', options=['--seed', '7']), rate())
        self.assertEqual(int(seed_7[0].split()[0]), EPOCH + 7 * SECOND)

    def assert_clocks(self, text, at):
        date, up = EPOCH + at, UPTIME + at
        microseconds = date // 1000
        self.assertEqual([int(word) for word in text.split()], [
            date, up, up, up, date, at, at, microseconds // 10 ** 6, microseconds % 10 ** 6, date // SECOND, date,
            at // 1000, date, up, date, up])

    def test_chance_depends_on_the_seed_and_on_the_nodes_name_and_never_repeats_itself(self):
        told = {}
        for key, options, name in (('plain', [], 'chance'), ('seed', ['--seed', '5'], 'chance'), ('name', [], 'other')):
            clocks, first, second, _now, third = self.texts(chance('agent', name=name, options=options), rate())[:5]
            told[key] = [first.split(), second.split()[len(clocks.split()):], third.split()]
        plain = sum(told['plain'], [])
        self.assertEqual(len(set(plain)), len(plain) - 4)  # the return values of getrandom() and getentropy() are equal
        for key in ('seed', 'name'):
            same = [[word for word, other in zip(*sections) if word == other]
                    for sections in zip(told['plain'], told[key])]
            # Draws of a generator that was seeded by the time are equal for all programs with that time.
            own = 2 if key == 'name' else 0
            self.assertEqual(same, [['12', '0'], told[key][1][:own] + ['12', '0'], told[key][2][:own] + ['12', '0']])

    def test_waits_of_the_standard_library_end_at_their_instants(self):
        expected = [
            ('spin_lock', 0, 50), ('sem_timedwait', -1, 55), ('sem_clockwait', -1, 60), ('try_lock_for', 0, 65),
            ('try_lock_shared_for', 0, 70), ('mutex_timedlock', errno.ETIMEDOUT, 75),
            ('timedrdlock', errno.ETIMEDOUT, 80), ('timedwrlock', errno.ETIMEDOUT, 85),
            ('clockrdlock', errno.ETIMEDOUT, 90), ('clockwrlock', errno.ETIMEDOUT, 95), ('wait_for', 1, 100),
            ('wait_until', 1, 105), ('rdlock', 0, 125), ('wrlock', 0, 150), ('sem_wait', 0, 175), ('future', 7, 200),
            ('timedjoin', errno.ETIMEDOUT, 205), ('join', 0, 225)]
        self.assertEqual(self.texts(chance('waits'))[5:], [
            f'{call} {result} {3 * SECOND // 2 + at * SECOND // 100}' for call, result, at in expected])

    def test_sleeps_without_descriptors_and_loops_that_look_at_a_clock(self):
        slept, looked = (text.split() for text in self.texts(chance('looks'))[5:])
        self.assertEqual(slept, ['slept', str(11 * SECOND // 100), str(3 * SECOND // 2)])
        self.assertEqual(looked, ['looked', str(11 * SECOND // 100 + 5 * 10 ** 6), str(3 * SECOND // 2 + 5 * 10 ** 6)])

    def test_what_is_not_followed_is_labelled_by_name_and_place(self):
        shared = 'a semaphore is shared with other processes'
        told = {what: what + '() is another number in another run' for what in ('getpid', 'getppid', 'gettid')}
        told.update(sem_open=shared, sem_init=shared, syscall='syscall(SYS_gettid) is another number in another run')
        told.update((what, what + '() says how long the processor has worked') for what in ('times', 'getrusage'))
        told.update((what, what + '() looks at a connection or a file, by the wall clock')
                    for what in ('poll', 'ppoll', 'select', 'pselect', 'epoll_wait', 'epoll_pwait'))
        told.update((what, what + '() has the kernel wake the program by the wall clock')
                    for what in ('timer_create', 'setitimer', 'alarm', 'ualarm'))
        told.update((what, what + '() starts a process that is not a participant: its answers depend on the machine')
                    for what in ('popen', 'system', 'fork', 'posix_spawn', 'posix_spawnp'))
        told.update((what, what + '() shares memory with other processes: they write to it by the wall clock')
                    for what in ('shm_open', 'shmget', 'mmap', 'mmap64'))
        told.update((what, what + '() opens a queue or semaphore of several processes: they use it by the wall clock')
                    for what in ('mq_open', 'msgget', 'semget'))
        told.update((what, what + "() is not followed: C11's threads take no turns, and wait by the wall clock")
                    for what in ('thrd_create', 'thrd_sleep', 'cnd_timedwait', 'mtx_timedlock'))
        told.update((what, what + '() says how busy the machine is') for what in ('getloadavg', 'sysinfo'))
        told['socket'] = 'socket() makes a connection: data arrives over it by the wall clock'
        told.update((what, 'a file in {} is opened: it describes this machine at this moment'.format(what))
                    for what in ('/proc', '/sys'))
        told['mmap64'] = told['mmap']  # one function on systems with files of 64 bits
        run = RUNS.run([chance('all')])
        labels = [re.fullmatch(r"'/chance': (.*) \(\S*/shim_chance\+0x[0-9a-f]+\)", label) for label in run.labels]
        self.assertNotIn(None, labels, run.labels)
        self.assertEqual(sorted(label.group(1) for label in labels), sorted(set(told.values())))
        self.assert_lines_in_log(run.labels)

    def assert_lines_in_log(self, labels):
        """Check that the launcher writes into the log at which line of the program each call stands."""
        with tempfile.NamedTemporaryFile('w+') as log:
            json.dump({'end': {'events': 0, 'repeatable': False, 'not_repeatable_because': labels}}, log)
            log.flush()
            bags.add_to_log(log.name, [])
            with open(log.name) as stream:
                found = json.load(stream)['end']['not_repeatable_because']
        self.assertEqual([label.partition(' (/')[0] for label in found],
                         [label.partition(' (/')[0] for label in labels])
        for label in found:
            self.assertRegex(label, r'\+0x[0-9a-f]+ \(\S+\.(h|cpp):[0-9]+, in .+\)\)$')

    def test_a_file_that_another_participant_writes_is_labelled(self):
        folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, folder)
        path = os.path.join(folder, 'results')
        for how, other in (('reads', 'writes'), ('writes', 'reads'), ('renames', 'reads'),
                           ('claims', 'claims'), ('asks', 'writes'), ('removes', 'asks'), ('locks', 'locks')):
            run = RUNS.run([Program('one', own('shim_chance'), what='file', file=path, how=how),
                            Program('two', own('shim_chance'), what='file', file=path, how=other)])
            self.assert_shared(run, path)
        odd = 'odd ' + os.fsdecode(b'\xff')  # a name may be any bytes, and Python and C++ report it in the same way
        run = RUNS.run([Program('one', own('shim_chance'), what='file', file=os.path.join(folder, odd[:-1]), odd=True,
                                how='writes'), Program('two', READS, 'reads', folder)])
        self.assert_shared(run, os.path.join(folder, r'odd \xff'))
        run = RUNS.run([Program(name, own('shim_chance'), what='file', file=path + at, how=how)
                        for name, at, how in (('one', '', 'reads'), ('two', '', 'reads'), ('three', '.3', 'writes'))])
        self.assertEqual(run.labels, [])

    def test_folders_are_listed_by_name_and_what_the_program_has_written_has_the_runs_date(self):
        folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, folder)
        names = [f'{number * 37 % 64:02}' for number in range(64)]
        for name in names:
            Path(folder, name).touch()
        listed, scanned, written = self.texts(chance('folder', file=folder))[5:]
        self.assertEqual(listed.split(), ['lists', *sorted(names), 'made', '..', '..', '.'])
        self.assertEqual(scanned.split(), ['scans', '.', '..', *sorted(names), 'made', '67'])
        self.assertEqual(written, f'written {EPOCH + 3 * SECOND // 2}')

    def assert_shared(self, run, path):
        self.assertEqual(len(run.labels), 1, run.labels)
        self.assertRegex(run.labels[0], "^'/(one|two)' (reads|writes) {}, which '/(one|two)' (reads|writes): data "
                                        'that passes between them'.format(re.escape(path)))

    def test_strict_ends_the_run_with_the_first_label_and_its_program_with_an_error(self):
        script = Program('loop', WALL_LOOP, options=['--strict'])
        for program, label in ((chance('getpid', options=['--strict']), "'/chance': getpid"),
                               (script, "'/loop': .* takes simulated time")):
            run = RUNS.run([program])
            self.assertEqual(run.code, 1)
            self.assertRegex(run.outputs[0], 'FATAL.*strict, and the run is not repeatable: ' + label)
            self.assertEqual(len(run.labels), 1, run.labels)

    def test_a_thread_from_before_ros_is_labelled_and_what_it_asks(self):
        run = RUNS.run([chance('stray', 'stray'), recorder('/told')])
        self.assertEqual([line.split(' ', 2)[2] for line in run.printed(-1)][5:], ['posted 0', 'promised 3'])
        labels = ' '.join(run.labels)
        for why in ('a thread that lockstep does not order has woken another one',
                    'a thread was started before ROS was',
                    'a random number is drawn in a thread that lockstep does not',
                    'a clock is read in a thread that lockstep does not order'):
            self.assertIn(why, labels)

    def addresses(self, layout):
        os.environ.pop(LAYOUT, None)
        if layout:
            os.environ[LAYOUT] = layout
        self.addCleanup(os.environ.pop, LAYOUT, None)
        return self.texts(chance('addresses'))[5:]

    def test_addresses_are_the_same_in_each_run_or_as_the_environment_says(self):
        self.assertEqual(self.addresses('fixed'), self.addresses(None))
        one, other = (self.addresses('random')[0].split()[1:] for _run in range(2))
        self.assertEqual([at for at, elsewhere in zip(one, other) if at == elsewhere], [])

    def test_an_unknown_layout_is_refused(self):
        told = subprocess.run([find_executable('lockstep'), own('shim_chance')], check=False, text=True,
                              env=dict(os.environ, **{LAYOUT: 'any'}), stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        self.assertEqual((told.returncode, told.stdout), (1, (
            "lockstep: the environment's {} must be 'fixed' or 'random', got 'any'\n".format(LAYOUT))))

    def test_what_the_launcher_could_not_see_to_is_labelled(self):
        """A program that is preloaded by hand gets its addresses, and all before ROS begins, from the machine."""
        labels = ' '.join(RUNS.run([Program(
            'chance', own('shim_chance'), launcher=['/usr/bin/env', 'LD_PRELOAD=' + find_shim(os.environ)],
            what='addresses')]).labels)
        self.assertIn('the system does not let addresses be the same in each run', labels)
        self.assertIn('the time master was not in lockstep yet when the program was started', labels)
