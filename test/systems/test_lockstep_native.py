"""Time and chance for C libraries in Python programs come from the run, or are labelled by file and place."""
import os
import re
import sys
import unittest
from unittest import mock

from lockstep_launcher_run import assert_same, run_programs, run_scenario

from move_base_abstract_ros.lockstep.programs import native_library
from move_base_abstract_ros.lockstep.programs.binary import find_shim

BY_CTYPES = find_shim(os.environ, 'libnative_sources.so')
SECOND = 10 ** 9
START = 1577836800  # 2020-01-01


def module():
    """Return [path of the module in C], or [] if it was not built for lack of Python's headers."""
    try:
        return [find_shim(os.environ, 'native_module.so')]
    except ValueError:
        return []


def run_native(path, *topics, options=(), name='native'):
    return run_programs({name: [list(options), 'native.py', path, *topics]}, until=30.0)


def said(run, topic, name='native'):
    """Return the output about a topic, [[word, ...], ...]; last come the program's clock and simulated time."""
    return [line.split()[1:] for line in run.printed(name) if line.startswith(topic + ' ')]


class FollowedTest(unittest.TestCase):
    # 'given' comes last: a thread of the library's own may be ready before its caller waits, or after that, and so the
    # caller looks at a clock once more or once less; 'spin' prints the number of earlier looks at its instant.
    TOPICS = 'clocks', 'sleeps', 'waits', 'timed', 'chance', 'files', 'spin', 'given'

    @classmethod
    def setUpClass(cls):
        cls.runs = run_scenario({'native': [[], 'native.py', BY_CTYPES, *cls.TOPICS]}, until=30.0)
        cls.by_module = [run_native(path, *cls.TOPICS) for path in module()]

    def test_libraries_see_the_same_in_each_run_with_and_without_pythons_lock(self):
        assert_same(self, self.runs)
        for run in self.by_module:
            self.assertEqual(run.printed('native'), self.runs[0].printed('native'))
            self.assertTrue(run.state.repeatable)

    def test_clocks_of_libraries_are_those_of_the_program(self):
        for run in (*self.runs, *self.by_module):
            for words in said(run, 'clocks'):
                date = int(words[-2])
                gone = date - START * SECOND
                up, seconds, milliseconds = 3600 * SECOND + gone, date // SECOND, gone % SECOND // 10 ** 6
                self.assertEqual([int(word) for word in words[:-2]], [
                    date, up, up, gone, seconds, gone % SECOND, seconds, gone % SECOND // 1000, seconds, seconds,
                    milliseconds, gone // 1000, date, up])
            self.assertEqual([words[-1] for words in said(run, 'clocks')], ['1.0', '2.503'])

    def test_clocks_of_libraries_go_on_with_their_sleeps_and_waits(self):
        for words in said(self.runs[0], 'sleeps'):
            self.assertEqual(' '.join(words[:14]), '0 10, 0 20, 0 20, 0 30, 0 40, 0 50, 0 130,')
        for words in said(self.runs[0], 'waits'):
            self.assertEqual(' '.join(words[:22]),
                             '1 10, 1 20, 1 30, 1 40, 110 50, 1 60, -1 7, -1 8, 1 9, 1 11, -1 12,')

        for words in said(self.runs[0], 'timed'):
            self.assertEqual(' '.join(words[:12]), '0 10, 0 20, 0 30, 0 40, 110 50, 0 0,')
        self.assertEqual([words[0] for words in said(self.runs[0], 'given')], ['11'] * 2)

    def test_loops_of_libraries_that_look_at_a_clock_let_time_go_on(self):
        self.assertEqual([float(words[-1]) for words in said(self.runs[0], 'spin')], [1.003, 2.5060000000000002])
        self.assertTrue(all(1010000 < int(words[0]) < 1020000 for words in said(self.runs[0], 'spin')))

    def test_chance_of_libraries_follows_from_seed_and_name_and_never_repeats_itself(self):
        others = [run_native(BY_CTYPES, 'chance', options=['--seed', '7']),
                  run_native(BY_CTYPES, 'chance', name='other')]
        drawn = said(self.runs[0], 'chance') + said(others[0], 'chance') + said(others[1], 'chance', 'other')
        *values, started = list(zip(*(words[:-2] for words in drawn)))
        # rand() and random() go on from the seed of the first round, which is the time; two runs have the same time.
        self.assertEqual([len(set(value)) for value in values], [5, 5] + [6] * (len(values) - 2))
        self.assertEqual(len(set(started)), len({words[-2][:10] for words in drawn}))  # srand(time(NULL))


class SimulatedTest(unittest.TestCase):
    def test_sleeps_of_libraries_take_simulated_time_where_those_of_the_program_do(self):
        run = run_native(BY_CTYPES, 'clocks', 'sleeps', 'seconds', options=['--sleep', 'simulated'])
        self.assertEqual([words[-1] for words in said(run, 'sleeps')], ['1.3', '5.1'])
        self.assertEqual([words[:2] for words in said(run, 'seconds')], [['0', '2000,']] * 2)
        self.assertEqual([set(words[:4]) for words in said(run, 'clocks')], [{str(SECOND)}, {'4800000000'}])
        self.assertTrue(run.state.repeatable)


class LabelledTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with mock.patch.dict(os.environ, MOVE_BASE_ABSTRACT_COMPUTE_LIMIT='0.5'):
            cls.run_ = run_native(BY_CTYPES, 'clocks', 'limit', 'threads', 'untold', 'strays')

    def test_what_cannot_be_followed_in_libraries_is_labelled_with_file_and_place(self):
        labels = list(self.run_.state.not_repeatable_because)
        for label in labels:
            self.assertRegex(label, r"^'/native': .+ \(\S*/libnative_sources\.so\+0x[0-9a-f]+\)$")
        words = ['looks at a clock, and has computed for 0.5 s', 'reads a clock in a thread', 'draws a random number',
                 r'times\(\)', r'getrusage\(\)', r'getloadavg\(\)', r'sysinfo\(\)', *['has the kernel wake'] * 4,
                 r'getpid\(\)', *['starts a process'] * 5, 'opens a device', 'has the kernel wake',
                 *['draws a random number'] * 6]
        self.assertEqual(len(labels), len(words), labels)
        for label, text in zip(labels, words):
            self.assertTrue(re.search(text, label), (label, text))

    def test_a_search_that_ends_by_a_clock_ends_and_a_thread_of_a_library_sees_its_own_sleeps(self):
        self.assertEqual([words[0] for words in said(self.run_, 'limit')], ['over'] * 2)
        self.assertEqual([words[0] for words in said(self.run_, 'threads')], ['30'] * 2)
        self.assertEqual(self.run_.codes, {'native': 0})

    def test_loops_of_a_library_have_one_thread_and_the_threads_of_one_that_is_told_to_have_more_are_labelled(self):
        path = find_shim(os.environ, 'libtbb_stand_in.so')
        run = run_programs({'pool': [[], 'pool.py', path, '0']}, until=30.0)
        self.assertEqual((run.printed('pool'), list(run.state.not_repeatable_because)), (['threads: 1 2.0'], []))
        run = run_programs({'pool': [[], 'pool.py', path, '2']}, until=30.0)
        self.assertEqual(run.printed('pool'), ['threads: 2 2.0'])
        self.assertEqual(len(run.state.not_repeatable_because), 1, run.state.not_repeatable_because)
        self.assertIn("'/pool': a library starts threads for its sums or loops", run.state.not_repeatable_because[0])

    def test_a_program_without_the_library_is_labelled(self):
        with mock.patch.dict(os.environ, LD_PRELOAD='/nowhere/' + native_library.LIBRARY):
            run = run_native(BY_CTYPES, 'clocks')
        self.assertEqual(len(run.state.not_repeatable_because), 1, run.outputs)
        self.assertIn('is not in this process', run.state.not_repeatable_because[0])
        self.assertGreater(int(said(run, 'clocks')[0][0]), 1.7e9 * SECOND)


class NeedsTest(unittest.TestCase):
    def test_python_keeps_what_it_needs_of_the_machine_and_its_children_all(self):
        runs = [run_programs({'native_needs': ['native_needs.py']}, until=30.0) for _ in range(2)]
        first, *rest = runs[0].printed('native_needs')
        self.assertEqual(runs[0].codes, {'native_needs': 0})
        self.assertEqual(rest, ['False False True True', '0', 'False 1.75',
                                '2020-01-01T00:00:01 2020-01-01 1577836801 1577836801.75'])
        self.assertNotEqual(first, runs[1].printed('native_needs')[0])  # keys of connections must not be predictable

    def test_another_library_that_is_preloaded_stays(self):
        line = [sys.executable, '-c', 'import os; print(os.environ.get("LD_PRELOAD"))']
        other = find_shim(os.environ, 'libmove_base_abstract_loopback_only.so')
        with mock.patch.dict(os.environ, LD_PRELOAD=other):
            environment = dict(os.environ)
            self.assertTrue(native_library.preload(environment))
            with os.popen('LD_PRELOAD="{}" {}'.format(environment['LD_PRELOAD'], ' '.join(
                    "'{}'".format(word) for word in line))) as output:
                self.assertEqual(output.read().strip(), other)
