"""Programs started by the launcher see and leave the same as without it."""

import os
import shutil
import subprocess
import sys
import tempfile
import unittest

from lockstep_launcher_run import FOLDER, GUARD, command, remaps, run_programs

from move_base_abstract_ros.loopback import Loopback, find_executable

CMAKE = """cmake_minimum_required(VERSION 3.12)
project(probes)
find_package(catkin REQUIRED)
catkin_package()
catkin_install_python(PROGRAMS scripts/probe.py scripts/failing.py DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
"""
PACKAGE = """<package format="2"><name>probes</name><version>0.0.0</version><description>none</description>
<maintainer email="a@example.org">a</maintainer><license>BSD</license>
<buildtool_depend>catkin</buildtool_depend><exec_depend>rospy</exec_depend></package>
"""
LAUNCH = """<launch>
  <group ns="fleet_7">
    <node name="renamed" pkg="probes" type="probe.py" args="--speed 3" output="screen"
        launch-prefix="rosrun move_base_abstract lockstep --rank 5">
      <param name="x" value="from launch"/>
      <remap from="topic" to="/elsewhere"/>
    </node>
  </group>
</launch>
"""


class StartTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix='lockstep_launcher_')
        cls.ros = Loopback().__enter__()  # for programs that run without lockstep
        for name in ('probe', 'plain_text', 'link.py'):
            shutil.copy(os.path.join(FOLDER, 'probe.py'), os.path.join(cls.folder, name))
        os.chmod(os.path.join(cls.folder, 'probe'), 0o755)
        with open(os.path.join(cls.folder, 'plain_text'), 'r+') as script:
            text = script.read().split('\n', 1)[1]  # without the first line, which names a Python
            script.seek(0)
            script.truncate()
            script.write(text)
        os.remove(os.path.join(cls.folder, 'link.py'))
        os.symlink(os.path.join(FOLDER, 'probe.py'), os.path.join(cls.folder, 'link.py'))
        os.environ['PYTHONPATH'] = FOLDER + os.pathsep + os.environ.get('PYTHONPATH', '')

    @classmethod
    def tearDownClass(cls):
        cls.ros.close()
        shutil.rmtree(cls.folder)

    def path(self, *names):
        return os.path.join(self.folder, *names)

    def as_without(self, **forms):
        """Assert that each form prints the same with the launcher as without it, with the same exit code."""
        run = run_programs(forms, until=5.0)
        for name, words in forms.items():
            python = sys.executable if words[0] == 'python3' else words[0]
            plain = [python, *words[1:]] if 'python' in os.path.basename(python) else [sys.executable, *words]
            done = subprocess.run(plain + remaps(name), check=False, env=self.ros.environment,
                                  stdout=subprocess.PIPE, text=True, timeout=GUARD)
            expected = [line for line in done.stdout.splitlines() if line]
            self.assertEqual(len(expected), 9, done.stdout)
            self.assertEqual(run.printed(name), expected, name)
            self.assertEqual((run.codes[name], done.returncode), (3, 3), run.outputs[name])
            self.assertNotIn('WARN', run.outputs[name])
        self.assertTrue(run.state.repeatable, run.state.not_repeatable_because)

    def test_scripts_with_a_suffix_without_one_and_links(self):
        script = os.path.join(FOLDER, 'probe.py')
        self.as_without(with_suffix=[script, '--flag', 'value', 'topic:=/there', '_x:=1'], without=[self.path('probe')],
                        **{'fleet_3/link': [self.path('link.py'), '_x:=[1, 2]', '-m', '--seed', '4']})

    def test_words_of_a_python_interpreter(self):
        script = os.path.join(FOLDER, 'probe.py')
        self.as_without(short=['python3', script, '-v'],
                        options=[sys.executable, '-u', '-W', 'ignore', script, 'a'],
                        no_script_by_itself=['python3', self.path('plain_text')],
                        module=['python3', '-m', 'probe', '--flag', '_y:=two'])

    def test_a_module_by_the_launchers_own_option(self):
        run = run_programs({'module': ['-m', 'probe', '-m', '_x:=1']}, until=5.0)
        self.assertIn("argv ['{}', '-m', '_x:=1', '__name:=module'], without remaps ['{}', '-m']".format(
            *[os.path.join(FOLDER, 'probe.py')] * 2), run.printed('module'))
        self.assertEqual(run.codes['module'], 3)

    def test_a_python_of_a_virtual_environment(self):
        subprocess.run([sys.executable, '-m', 'venv', '--without-pip', '--system-site-packages', self.path('venv')],
                       check=True)
        python = self.path('venv', 'bin', 'python3')
        with open(os.path.join(FOLDER, 'probe.py')) as source:
            text = source.read().split('\n', 1)[1]
        with open(self.path('of_venv'), 'w') as script:
            script.write('#!{}\nimport sys\nprint(sys.prefix)\n{}'.format(python, text))
        run = run_programs({'first_line': [self.path('of_venv')], 'word': [python, os.path.join(FOLDER, 'probe.py')]},
                           until=5.0)
        self.assertEqual(run.printed('first_line')[0], self.path('venv'))
        self.assertEqual((run.codes['first_line'], run.codes['word']), (3, 3), run.outputs)

    def test_relays_of_catkin_installed_scripts_and_launch_files(self):
        self.build()
        devel = self.path('devel', 'lib', 'probes', 'probe.py')
        with open(devel) as relay:
            self.assertIn('creates a relay', relay.read())
        installed = self.path('install', 'lib', 'probes', 'probe.py')
        self.as_without(relay=[devel, '--flag', '_x:=1'], installed=[installed])
        failing = self.path('devel', 'lib', 'probes', 'failing.py')
        self.check_traceback(failing, ['context)', 'main()', 'rospy.get_time'])
        self.check_launch_file()

    def build(self):
        """Build and install a catkin package with these scripts."""
        source = self.path('source')
        os.makedirs(os.path.join(source, 'scripts'))
        for name, text in (('CMakeLists.txt', CMAKE), ('package.xml', PACKAGE), ('start.launch', LAUNCH)):
            with open(os.path.join(source, name), 'w') as stream:
                stream.write(text)
        for name in ('probe.py', 'failing.py'):
            shutil.copy(os.path.join(FOLDER, name), os.path.join(source, 'scripts'))
        configure = ['cmake', '-S', source, '-B', self.path('build'), '-DPYTHON_EXECUTABLE=' + sys.executable,
                     '-DCATKIN_DEVEL_PREFIX=' + self.path('devel'), '-DCMAKE_INSTALL_PREFIX=' + self.path('install')]
        for words in (configure, ['make', '-C', self.path('build'), 'install']):
            done = subprocess.run(words, check=False, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
            self.assertEqual(done.returncode, 0, done.stdout)

    def check_launch_file(self):
        """Check that the launch file's node takes part with its name, parameter, remap and arguments."""
        environment = os.environ.copy()
        os.environ['ROS_PACKAGE_PATH'] = self.path('source') + os.pathsep + os.environ.get('ROS_PACKAGE_PATH', '')
        os.environ['CMAKE_PREFIX_PATH'] = self.path('devel') + os.pathsep + os.environ.get('CMAKE_PREFIX_PATH', '')
        try:
            run = run_programs({'fleet_7/renamed': None}, until=5.0, commands={
                'fleet_7/renamed': [shutil.which('roslaunch'), self.path('source', 'start.launch')]})
        finally:
            os.environ.clear()
            os.environ.update(environment)
        said = run.outputs['fleet_7/renamed']
        devel = self.path('devel', 'lib', 'probes', 'probe.py')
        self.assertIn("without remaps ['{}', '--speed', '3']".format(devel), said)
        self.assertIn('name /fleet_7/renamed, topic /elsewhere, parameters from launch None', said)
        self.assertIn('exit code 3', said)
        self.assertTrue(run.state.repeatable, run.state.not_repeatable_because)

    def check_traceback(self, script, lines):
        """Check that the traceback of a failing script begins in the program itself."""
        run = run_programs({'failing': [script]}, until=5.0)
        self.assertEqual(run.codes['failing'], 1)
        said = run.outputs['failing']
        self.assertNotIn('move_base_abstract_ros', said)
        self.assertNotIn('runpy', said)
        self.assertIn('RuntimeError: at 2.5 s', said)
        places = [line for line in said.splitlines() if line.startswith('  File ')]
        self.assertEqual(len(places), 2 + len(lines), said)
        for line in lines:
            self.assertIn(line, said)

    def test_a_traceback_has_no_line_of_the_launcher(self):
        self.check_traceback(os.path.join(FOLDER, 'failing.py'), ['main()', 'rospy.get_time'])

    def test_exit_codes(self):
        endings = {'zero': 'pass', 'text': "raise SystemExit('enough')", 'three': 'raise SystemExit(3)',
                   'hard': 'import os; os._exit(5)', 'interrupt': 'raise KeyboardInterrupt()', 'error': '1 / 0'}
        for name, ending in endings.items():
            with open(self.path(name + '.py'), 'w') as script:
                script.write("import rospy\nrospy.init_node('a')\nrospy.sleep(0.5)\n{}\n".format(ending))
        run = run_programs({name: [self.path(name + '.py')] for name in endings}, until=5.0)
        self.assertEqual(run.codes, {'zero': 0, 'text': 1, 'three': 3, 'hard': 5, 'interrupt': 130, 'error': 1})
        self.assertIn('enough', run.outputs['text'])
        self.assertIn('KeyboardInterrupt', run.outputs['interrupt'])

    def test_what_cannot_be_started(self):
        for name, text in (('shell', '#!/bin/sh\necho no\n'), ('perl', '#!/usr/bin/perl\n')):
            with open(self.path(name), 'w') as script:
                script.write(text)
        for words, text in ((['/there/is/none.py'], "there is no program '/there/is/none.py'"),
                            ([self.path('perl')], 'neither a Python or shell script nor a binary'),
                            ([self.path('shell')], 'Permission denied'),
                            (['-m'], '-m needs the name of a module'),
                            (['python3', '-c', 'pass'], "'-c' of a Python interpreter is not possible"),
                            (['python3'], 'needs a script or -m MODULE'), ([], 'no program was given'),
                            (['--sleep', 'never', 'x.py'], "invalid choice: 'never'")):
            done = subprocess.run([sys.executable, find_executable('lockstep'), *words], check=False, text=True,
                                  env=self.ros.environment, stderr=subprocess.PIPE, timeout=GUARD)
            self.assertIn(text, done.stderr)
            self.assertNotEqual(done.returncode, 0)
            self.assertNotIn('Traceback', done.stderr)

    def test_without_lockstep_a_program_runs_as_ever(self):
        with Loopback() as ros:
            ros.run('time_master', 'time_master', parameters={'mode': 'scaled', 'factor': 100.0})
            child = ros.spawn('/poller', command(['poller.py', '_ticks:=5'], 'poller'))
            self.assertEqual(child.process.wait(GUARD), 0)
            with open(child.log_path) as log:
                self.assertIn('tick 5 x=nan of 0', log.read())


class HabitsTest(unittest.TestCase):
    """Calls that lockstep cannot follow are reported, and others are not."""

    @classmethod
    def setUpClass(cls):
        cls.run_once = run_programs({'habits': ['habits.py']}, until=10.0)

    def test_each_is_told_once_with_file_and_line(self):
        with open(os.path.join(FOLDER, 'habits.py')) as script:
            lines = script.read().split('\n')
        told = []
        for text in self.run_once.logged('habits', 'WARN'):
            place = text.split(os.path.join(FOLDER, 'habits.py') + ', line ')
            self.assertEqual(len(place), 2, text)
            line = int(place[1].split(':')[0])
            told.append((place[0].split('/habits: ')[1][:-len(' in ')], lines[line - 1].strip()))
        self.assertEqual(sorted(told), sorted([
            ('time.sleep', 'time.sleep(0.3)  # let them connect'), ('time.sleep', 'sleep(0.1)'),
            ('socket.bind', "listener.bind(('127.0.0.1', 0))"),
            ('socket.connect', 'connection = socket.create_connection(listener.getsockname())'),
            ('subprocess.Popen', "print(subprocess.check_output(['echo', 'hi']).decode().strip())"),
            ('os.fork', 'process.start()')]))

    def test_it_goes_on_all_the_same(self):
        # During a sleep in wall time nodes connect and a message comes, at the same instant of simulated time.
        lines = self.run_once.printed('habits')
        self.assertEqual(lines[:4], ['1.000000000 heard 1', 'hi', 'child 7', '3.500000000 heard 3'])
        self.assertEqual(self.run_once.codes, {'habits': 0})
        labels = ' '.join(self.run_once.state.not_repeatable_because)
        self.assertFalse(self.run_once.state.repeatable)
        for name in ('socket.bind', 'socket.connect', 'subprocess.Popen', 'os.fork'):
            self.assertIn("'/habits': {} in ".format(name), labels)
        self.assertNotIn('time.sleep', labels)

    def test_random_identifiers_are_repeated(self):
        again = run_programs({'habits': ['habits.py']}, until=10.0)
        self.assertEqual(again.printed('habits'), self.run_once.printed('habits'))
        self.assertRegex(again.printed('habits')[-1], '^id [0-9a-f]{8}-[0-9a-f]{4}-4')

    def test_sleep_in_simulated_time(self):
        run = run_programs({'loop': [['--sleep', 'simulated'], 'wall_loop.py'], 'greeter': [
            shutil.which('rostopic'), 'pub', '-r', '2', 'greeting', 'std_msgs/String', 'data: hello']}, until=10.0)
        # A message comes twice a second; the first one comes before the nodes know each other.
        self.assertEqual(run.printed('loop'), ['2.600000000 after 16 looks'])
        self.assertEqual(run.logged('loop', 'WARN'), [])

    def test_sleeping_in_wall_time_for_what_comes_later_takes_simulated_time_after_a_while(self):
        run = run_programs({'loop': ['wall_loop.py'], 'greeter': [
            shutil.which('rostopic'), 'pub', '-r', '2', 'greeting', 'std_msgs/String', 'data: hello']}, until=10.0)
        # 5 s of looks at the first instant, then as above.
        self.assertEqual(run.printed('loop'), ['2.600000000 after 66 looks'])
        self.assertIn('from here on it takes simulated time', run.logged('loop', 'WARN')[-1])
        self.assertIn('from here on it takes simulated time', ' '.join(run.state.not_repeatable_because))

    def test_waits_in_the_kernel_with_a_time_out_are_sleeps(self):
        greeter = [shutil.which('rostopic'), 'pub', '-r', '2', 'greeting', 'std_msgs/String', 'data: hello']
        run = run_programs({'waits': [['--sleep', 'simulated'], 'kernel_waits.py'], 'greeter': greeter}, until=20.0)
        lines = run.printed('waits')
        self.assertEqual(lines[-2:], ["1 1 1 b'x'", 'slept'])
        self.assertEqual([line.split()[0] for line in lines[:-2]],
                         ['selector', 'poll', 'epoll', 'select', 'recv', 'queue', 'event', 'mutex', 'lock'])
        self.assertEqual({line.partition(' after ')[2] for line in lines[1:-2] if 'queue' not in line}, {'2 looks'})
        labels = ' '.join(run.state.not_repeatable_because)
        for name in ('selectors', 'select.poll', 'select.select', 'socket.recv', 'multiprocessing'):
            self.assertIn("'/waits': {} in ".format(name), labels)
        self.assertNotIn('takes simulated time', labels)

    def test_after_a_while_they_take_simulated_time(self):
        greeter = [shutil.which('rostopic'), 'pub', '-r', '2', 'greeting', 'std_msgs/String', 'data: hello']
        run = run_programs({'waits': ['kernel_waits.py'], 'greeter': greeter}, until=20.0)
        self.assertEqual(run.printed('waits')[-1], 'slept')
        self.assertIn('from here on it takes simulated time', ' '.join(run.state.not_repeatable_because))
