"""Time and chance for unmodified rospy programs come from the run, or are labelled with name, file and line."""
import ast
import os
import re
import shutil
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

from lockstep_launcher_run import FOLDER, assert_same, run_programs, run_scenario
from own_folder import OwnFolder

from move_base_abstract_ros.loopback import find_executable

#: text in the line of a label, if it is not the last part of the name
SHOWN = {'subprocess.Popen': 'check_output', 'os.fork': 'child.start()',
         'socket.connect': 'create_connection', 'ctypes.dlsym': "CDLL('libc.so.6').time", 'hash': 'hash',
         'open': "('/", 'xmlrpc.client.ServerProxy': 'getSubscriptions',
         'rospy.get_param': 'get_param(', 'os.exec': 'os.execv', 'builtins.input': 'input()',
         'id': 'id', 'f-string': "f'", '%': '%', 'str': 'str', 'repr': 'repr',
         'multiprocessing.process.BaseProcess.pid': '.pid', 'threading.Thread.native_id': '.native_id'}
LABEL = re.compile(r"'/\w+': (a clock|\S+) in (\S+), line (\d+): ")


def places(run, script):
    """Return [(name, line of the script)] for a run's labels; check that all are about this script."""
    path = os.path.join(FOLDER, script)
    with open(path) as source:
        text = source.read().splitlines()
    found = []
    for label in run.state.not_repeatable_because:
        told = LABEL.match(label)
        assert told and told.group(2) == path, label
        found.append((told.group(1), text[int(told.group(3)) - 1]))
    return found


class FollowedTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.runs = run_scenario({'sources': ['sources.py']}, until=30.0)
        cls.runs.append(run_programs({'sources': ['sources.py']}, until=30.0))  # chance shows in a second run only
        cls.said = [ast.literal_eval(line) for line in cls.runs[0].printed('sources')]

    def test_all_sources_say_the_same_in_each_run(self):
        self.assertEqual(self.runs[0].codes, {'sources': 0})
        self.assertEqual(len(self.said), 12)
        assert_same(self, self.runs)

    def test_clocks_go_by_simulated_time_from_a_date_of_the_seed_on(self):
        for said, gone in ((self.said[0], 0.0), (self.said[5], 2.5)):
            date, up = 1577836800.0 + gone, 3600.0 + gone
            whole = [int(clock * 10 ** 9) for clock in (date, up, gone)]
            self.assertEqual(said, [date, whole[0], up, whole[1], up, whole[1], gone, whole[2], gone, whole[2], date,
                                    up, whole[2], up, date])
        self.assertEqual(self.said[6], [
            (2020, 1, 1, 0, 0, 2), 2, '20', 'Wed Jan  1 00:00:02 2020', '2020', '02', '2020',
            '2020-01-01 00:00:02.500000+00:00', '2020-01-01 00:00:02.500000', 2, 500000, 2020, 0, '02e10b5e',
            'Wed, 01 Jan 2020 00:00:02 -0000', '2020-01-01 00:00:02', '2020-01-01 00:00:02.500000'])

    def test_chance_depends_on_the_seed_and_on_the_nodes_name_and_never_repeats_itself(self):
        seed_7 = run_programs({'sources': [['--seed', '7'], 'sources.py']}, until=30.0)
        other = run_programs({'other': ['sources.py']}, until=30.0)
        drawn, names = [], []
        for run, name in ((self.runs[0], 'sources'), (seed_7, 'sources'), (other, 'other')):
            said = [ast.literal_eval(line) for line in run.printed(name)]
            drawn += [said[2], said[7]]
            names += said[3][:2] + said[8][:2]  # names of temporary files
        self.assertEqual(ast.literal_eval(seed_7.printed('sources')[0])[0], 1577836807.0)
        self.assertEqual(len(set(names)), 12)
        # Equal are b'', the hash of a text, and draws from a generator that starts from the time.
        few = {11: 1, 14: 1, 15: 4}
        self.assertEqual([len(set(values)) for values in zip(*drawn)], [few.get(place, 6) for place in range(20)])

    def test_threads_the_computer_and_dates_by_the_way_are_the_runs(self):
        for said, count, second, rest in ((self.said[4], 1, '00', '000'), (self.said[9], 3, '02', '500')):
            self.assertEqual(said[0], 'Thread-{}'.format(count))
            self.assertTrue(said[1].startswith('Thread-{}'.format(count + 1)), said)
            self.assertEqual(said[2:], [
                4, '2020-01-01 00:00:{},{} said'.format(second, rest),
                ('2020-01-01 00:00:' + second, '2020-01-01', '00:00:{}.{}'.format(second, rest),
                 '2001-02-04 00:00:00', '2020-01-01'), 8, '<__main__.Clock object', '[0.0, 0, None]'])

    def test_folders_are_listed_by_name(self):
        for said in (self.said[3], self.said[8]):
            names = ['a', 'ab', 'b', 'c']
            self.assertEqual(said[2:], [names, names, [said[0] + '/' + name for name in names], names, [names]])

    def test_waits_end_at_their_instants_and_loops_that_look_at_a_clock_go_on(self):
        self.assertEqual(self.said[10], [
            'empty', '3602.750000', 'False', '3602.875000', '([], [], [])', '3602.937500', 'None', '3602.968750',
            '3.251', '3603.468750', '[(0.1, 3.474999904), (0.2, 3.575000047)]', '3603.668750',
            '(3.585000047, 1997, 3.587000047)', '3603.680750'])


# A program that tells others where its temporary files are.
TELLS_PATH = """import tempfile
import rospy
from std_msgs.msg import String
rospy.init_node('tells')
rospy.Subscriber('path', String, lambda path: None)
publisher = rospy.Publisher('path', String, queue_size=1)
rospy.sleep(1)
publisher.publish(tempfile.mkdtemp())
"""


class PathTest(OwnFolder, unittest.TestCase):
    def test_a_temporary_path_that_is_sent_labels_a_run_that_goes_on_beside_another_one(self):
        tells, labels = self.write('tells.py', TELLS_PATH), []
        for name in ('01', '02'):
            folder = self.path('move_base_abstract_run_0_' + name)
            os.mkdir(folder)
            with mock.patch.dict(os.environ, TMPDIR=folder):
                labels.append(list(run_programs({'tells': [tells]}, until=3.0).state.not_repeatable_because))
        self.assertEqual(labels[0], [])
        self.assertEqual(len(labels[1]), 1)
        self.assertIn('{}, line 8: a path of a temporary file is sent'.format(tells), labels[1][0])


class LabelledTest(unittest.TestCase):
    def test_what_is_not_followed_is_labelled_by_name_file_and_line(self):
        run = run_programs({'untold': ['untold.py']}, until=10.0)
        self.assertEqual(run.codes, {'untold': 0}, run.outputs)
        with open(os.path.join(FOLDER, 'untold.py')) as script:
            names = re.findall(r"'([-%a-zA-Z_0-9. ]+)': ", script.read())
        found = places(run, 'untold.py')
        self.assertIn('of /proc/NUMBER/stat: ', '\n'.join(run.state.not_repeatable_because))
        self.assertEqual(sorted(name for name, _line in found), sorted(' '.join(names).split()))
        for name, line in found:
            self.assertIn(SHOWN.get(name, name.rpartition('.')[2] + '('), line)

    def test_a_file_that_another_participant_writes_in_whatever_way_is_labelled(self):
        with tempfile.TemporaryDirectory(prefix='lockstep_chance_') as folder:
            os.mkdir(os.path.join(folder, '__pycache__'))
            Path(folder, 'claim').touch()
            run = run_programs({what: ['shares.py', what, folder] for what in ('writes', 'reads')}, until=10.0)
            self.assertEqual(run.codes, {'writes': 0, 'reads': 0}, run.outputs)
            names = [re.sub(r"^'/(?:writes|reads)' (?:writes|reads) {}/(.+), which .+: data that passes between them "
                            'is not in the order of simulated time$'.format(folder), r'\1', label)
                     for label in run.state.not_repeatable_because]
        self.assertEqual(sorted(names), ['asked', 'claim', 'copy', 'create', 'log', 'note', r'odd \xff', 'replace',
                                         'save', 'store'])


class ThreadsTest(unittest.TestCase):
    """A program that starts threads before it is a node, and makes a temporary folder."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix='lockstep_chance_')
        try:
            cls.early, cls.again = cls.run_once('early'), cls.run_once('early', ahead=1.5)
            cls.stray = cls.run_once('stray', PYTHONHASHSEED='random')
        finally:
            shutil.rmtree(cls.folder)

    @classmethod
    def run_once(cls, name, ahead=0.0, **environment):
        """Return a run; ahead: the time for which the program has to look for the time master [s, wall]."""
        command = [sys.executable, find_executable('lockstep'), os.path.join(FOLDER, 'early_threads.py')]
        words = ['__name:=' + name] if name == 'early' else []  # otherwise its name is unknown before it is a node
        with mock.patch.dict(os.environ, TMPDIR=cls.folder, **environment):
            return run_programs({name: None}, until=10.0, commands={name: command + words}, ahead=ahead)

    def test_a_thread_from_before_the_node_takes_turns_or_is_labelled(self):
        self.assertEqual((self.early.codes, self.again.codes), ({'early': 0}, {'early': 0}), self.early.outputs)
        self.assertEqual(self.early.printed('early'), self.again.printed('early')[-8:])
        self.assertTrue(self.early.state.repeatable)
        self.assertEqual([line.split()[:2] for line in self.early.printed('early')], [
            [name, '%.3f' % (1577836801.0 + 0.3 * n)] for n in range(4) for name in ('pool', 'thread')])
        labels = ' '.join(self.stray.state.not_repeatable_because)
        for text in ('a clock', 'chance', 'threading.Thread.start'):
            self.assertIn(': {} in {}, line '.format(text, os.path.join(FOLDER, 'early_threads.py')), labels)

    def test_a_temporary_name_that_is_taken_is_labelled(self):
        self.assertEqual(places(self.again, 'early_threads.py'), [('tempfile', 'tempfile.mkdtemp()')])

    def test_texts_that_are_hashed_at_random_are_labelled(self):
        self.assertIn('strings have other hashes in each run', ' '.join(self.stray.state.not_repeatable_because))


class GarbageTest(unittest.TestCase):
    def test_garbage_is_collected_in_rounds(self):
        runs = run_scenario({'litter': ['litter.py']}, until=30.0)
        self.assertEqual(runs[0].codes, {'litter': 0}, runs[0].outputs)
        said = runs[0].printed('litter')
        self.assertEqual(said[0], 'at once 0')
        self.assertEqual(len(said), 2 + 30)
        self.assertEqual(said[-1], 'waited 0.25')
        assert_same(self, runs)


class PoolsTest(unittest.TestCase):
    def test_pools_of_threads_do_the_same_in_each_run_whatever_their_addresses(self):
        runs = run_scenario({'pools': ['pools.py']}, until=10.0)
        with mock.patch.dict(os.environ, MOVE_BASE_ABSTRACT_ADDRESS_LAYOUT='random'):
            runs.append(run_programs({'pools': ['pools.py']}, until=10.0))
        self.assertEqual(runs[0].codes, {'pools': 0}, runs[0].outputs)
        self.assertEqual(runs[0].log.count(b'"message"'), 8)
        self.assertEqual(runs[0].printed('pools'), ['timeout after 0.5 [0, 1]'])
        assert_same(self, runs)

    def test_pools_of_processes_work_while_time_stands_and_are_labelled(self):
        run = run_programs({'squares': ['process_pools.py']}, until=10.0)
        self.assertEqual((run.printed('squares'), run.codes), (
            ['2.000000000 [0, 1, 4, 9, 16]'] * 2 + ['2.000000000 -15', '2.000000000 0'], {'squares': 0}))
        labels = ' '.join(run.state.not_repeatable_because)
        for name in ('os.fork', '_posixsubprocess.fork_exec'):
            self.assertIn("'/squares': {} in {}, line ".format(name, os.path.join(FOLDER, 'process_pools.py')), labels)


WORKSPACE = {
    '.catkin': '', 'lib/python3/dist-packages/others/msg/_Made.py': 'import os\nnumber = os.getpid()\n',
    'lib/python3/dist-packages/others/msg/__init__.py': '', 'lib/python3/dist-packages/others/__init__.py': """
import datetime
import os
import others.msg._Made


def tell():
    return datetime.datetime.now().year, os.getpid() > 0
""", 'program.py': """
import others
import rospy
rospy.init_node('program')
print(others.tell())
"""}


class WorkspaceTest(OwnFolder, unittest.TestCase):
    def test_packages_of_a_workspace_that_are_installed_are_the_programs_own(self):
        for name, text in WORKSPACE.items():
            self.write(name, text)
        packages = self.path('lib/python3/dist-packages')
        paths = {name: os.pathsep.join([first, os.environ[name]]) for name, first in (
            ('CMAKE_PREFIX_PATH', self.folder), ('PYTHONPATH', packages))}
        with mock.patch.dict(os.environ, paths):
            run = run_programs({'program': [self.path('program.py')]}, until=5.0)
        self.assertEqual(run.printed('program'), ['(2020, True)'], run.outputs)
        self.assertEqual(list(run.state.not_repeatable_because), [
            "'/program': os.getpid in {}/others/__init__.py, line 8: is another number in another run".format(
                packages)])


class SetsTest(unittest.TestCase):
    """The order of sets of the program's own objects repeats; other sets are labelled with file and line."""

    def test_sets_of_the_programs_own_objects_repeat(self):
        runs = [run_programs({'dispatcher': ['dispatcher.py']}, until=30.0) for _ in range(4)]
        assert_same(self, runs)
        given, idle, *others = runs[0].printed('dispatcher')
        # In the order of numbers; the object that was hashed first comes first.
        self.assertEqual(len(given.split()), 60)
        self.assertGreater(len(idle.split()), 3)
        self.assertEqual(others, [
            '1', '1 True', "True True True ['CARRIER', 'SCOUT']",
            "{'name': 'robot_3', 'kind': <Kind.SCOUT: 1>, 'padding': 'x'}"])

    def test_what_an_address_would_decide_is_the_same_with_other_addresses_and_beside_load(self):
        runs = run_scenario({'addresses': ['addresses.py']}, until=10.0)
        with mock.patch.dict(os.environ, MOVE_BASE_ABSTRACT_ADDRESS_LAYOUT='random'):
            runs.append(run_programs({'addresses': ['addresses.py']}, until=10.0))
        assert_same(self, runs)
        self.assertEqual([run.printed('addresses') for run in runs], [runs[0].printed('addresses')] * len(runs))
        self.assertEqual(len(runs[0].printed('addresses')), 10)

    def test_those_of_others_are_told_with_file_and_line(self):
        run = run_programs({'shifts': ['shifts.py']}, until=5.0)
        path = os.path.join(FOLDER, 'shifts.py')
        with open(path) as script:
            lines = script.read().splitlines()
        expected = [(1 + number, kinds) for number, line in enumerate(lines) for text, kinds in (
            ('for thread in threads:', 'threading.Thread'),
            ('first =', 'builtins.builtin_function_or_method, builtins.function'),
            ('slots =', 'slots.Slot'), ('any(said', 'builtins.method')) if line.startswith(text)]
        self.assertEqual(len(expected), 4)
        self.assertEqual(list(run.state.not_repeatable_because), [
            "'/shifts': {}, line {}: goes through a set of objects that Python hashes by their address ({}): "
            'its order differs from run to run; a list or a dict keeps the order in which it was filled'.format(
                path, number, kinds) for number, kinds in expected])
        self.assertEqual(len([line for line in run.logged('shifts', 'WARN') if 'goes through a set' in line]), 4)
