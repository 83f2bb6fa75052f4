"""SIGINT and SIGTERM in lockstep: the end of a whole run causes no label, in any order; the end of one node does."""

import functools
import os
import signal
import unittest

from lockstep_library_run import Run, Runs, read, wait_for_end
from waiting import wait_for, wait_for_words

from move_base_abstract_ros.lockstep.participation import finish
from move_base_abstract_ros.loopback import find_executable

RUNS = Runs()
ROLES = ('ticks', 'thinks', 'computes', 'shuts_down_late')
MASTER = 'time_master'
CPP = 'shim_rate'
INT, TERM = signal.SIGINT, signal.SIGTERM
os.environ['ROSCONSOLE_STDOUT_LINE_BUFFERED'] = '1'


class System:
    """Nodes that go on for ever; ``processes`` has them and the time master by name."""

    def __init__(self, **parameters):
        master, self._path = RUNS.start_master([*ROLES, CPP], **parameters)
        self.processes = {role: RUNS.start_node('ends', role) for role in ROLES}
        self.processes[CPP] = self._start_cpp()
        self.processes[MASTER] = master
        self._wait_for_ticks()

    @staticmethod
    def _start_cpp():
        for key, value in (('frequency', 1.0), ('ticks', 10 ** 9), ('quiet', True)):
            RUNS.ros.set_param('/{}/{}'.format(CPP, key), value)
        return RUNS.ros.spawn('/' + CPP, [find_executable('lockstep'), find_executable(CPP), '__name:=' + CPP])

    def _wait_for_ticks(self):
        wait_for(lambda: 'ticks: ' + '\n'.join(map(read, self.processes.values())),
                 lambda: self._log().count('"ticks"') >= 5)

    def _log(self):
        if not os.path.exists(self._path + '.part'):
            return ''
        with open(self._path + '.part', encoding='utf-8') as log:
            return log.read()

    def wait_for_output(self, name, words):
        wait_for_words(self.processes[name], words)

    def signal(self, *names, number=INT):
        for name in names:
            self.processes[name].process.send_signal(number)

    def wait(self, *names):
        for name in names:
            wait_for_end(self.processes[name], self.processes)

    def run(self):
        """Return the Run, when all processes have ended."""
        self.wait(*self.processes)
        codes = {name: child.process.returncode for name, child in self.processes.items()}
        return Run(self._path, codes, {name: read(child) for name, child in self.processes.items()})


class OwnInterruptTest(unittest.TestCase):
    """Who has raised a KeyboardInterrupt: the program, which is a crash like any other, or a signal."""

    def _caught(self, ends):
        before = signal.getsignal(INT)
        try:
            ends()
        except KeyboardInterrupt as error:
            return finish._is_raised_by_program(error)
        finally:
            signal.signal(INT, before)
        return None

    def test_it_is_known(self):
        def raises(*_):
            raise KeyboardInterrupt

        def comes(handler):
            signal.signal(INT, handler)
            os.kill(os.getpid(), INT)
            while True:
                signal.sigtimedwait((), 0.01)

        def again(error):
            try:
                comes(signal.default_int_handler)
            except KeyboardInterrupt:
                if error is None:
                    raise
                raise error()  # noqa: B904 - as a program may
        self.assertIs(self._caught(raises), True)
        for handler in (signal.default_int_handler, raises, self._method, functools.partial(raises)):
            self.assertIs(self._caught(lambda handler=handler: comes(handler)), False, handler)
        for error in (None, KeyboardInterrupt):
            self.assertIs(self._caught(lambda error=error: again(error)), False, error)

    def _method(self, *_):
        raise KeyboardInterrupt


class InterruptTest(unittest.TestCase):
    """Ends of whole runs, and of single nodes."""

    def test_the_end_of_all_labels_nothing_and_is_a_beginning_of_the_same_log(self):
        everybody = [*ROLES, CPP, MASTER]
        runs = [self._ended(lambda system, order=order, number=number: system.signal(*order, number=number))
                for order, number in ((everybody, INT), (everybody[::-1], INT))]
        runs.append(self._ended(self._terminate))
        runs.append(self._ended(lambda system: (system.signal(*everybody), system.signal(*everybody))))
        longest = max(runs, key=lambda run: len(run.all)).all
        for run in runs:
            self.assertNotIn('FATAL', ''.join(run.outputs.values()))
            self.assertIn(run.exit_codes[CPP], (0, -TERM))  # roscpp does not handle SIGTERM
            self.assertEqual(run.end['not_repeatable_because'], [])
            self.assertEqual(run.end['degraded_because'], [])
            self.assertEqual(run.all, longest[:len(run.all)])
            self.assertNotIn('a last word', [event[2] for event in run.all])

    @staticmethod
    def _terminate(system):
        """Send SIGTERM to all. The C++ program dies of it at once, so it gets it after the others."""
        system.signal(*ROLES, number=TERM)
        system.wait_for_output(MASTER, 'is told to end')
        system.signal(CPP, MASTER, number=TERM)

    def test_who_ends_them_one_after_the_other_may_take_its_time(self):
        def end(system):
            for name in (*ROLES, CPP, MASTER):
                system.signal(name)
                system.wait(name)
        run = self._ended(end)
        self.assertEqual(run.end['not_repeatable_because'], [])
        self.assertEqual(run.end['degraded_because'], [])
        self.assertNotIn('a last word', [event[2] for event in run.all])

    def test_the_end_of_one_among_others_is_a_label(self):
        for name in ('thinks', 'computes', CPP):
            system = System()
            system.signal(name)
            system.wait(name)
            system.wait_for_output(MASTER, 'the run is not repeatable')
            system.signal(*[other for other in system.processes if other != name])
            labels = system.run().end['not_repeatable_because']
            self.assertEqual(len(labels), 1, labels)
            self.assertRegex(labels[0], "^'/{}' left at [0-9.]+ s, when the wall clock said so$".format(name))

    def test_a_run_can_end_with_a_participant(self):
        names = ('ends_soon', 'ticks')
        master, path = RUNS.start_master(names, end_with=['ends_soon'])
        nodes = {name: RUNS.start_node('ends', name) for name in names}
        for child in (*nodes.values(), master):
            wait_for_end(child, nodes)
        self.assertEqual(master.process.returncode, 0, read(master))
        run = Run(path, {}, {name: read(node) for name, node in nodes.items()})
        self.assertEqual([run.end[key] for key in ('ended_by', 'node', 'at_ns')],
                         ['departure', '/ends_soon', 3500000000])
        self.assertTrue(run.end['repeatable'])
        self.assertEqual(run.of('ticks')[-1], (3.0, 'ticks', 2))

    def _ended(self, act):
        system = System()
        act(system)
        return system.run()
