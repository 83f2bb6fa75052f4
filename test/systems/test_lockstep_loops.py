"""Scripts that wait in loops without sleep, and scripts that log and publish much while they compute."""

import os
import shutil
import unittest

from lockstep_launcher_run import FOLDER, Scenario, assert_same, run_programs, run_scenario
from own_folder import OwnFolder
from roslib.packages import find_node

# The relay that catkin makes for a script in its devel space.
RELAY = """#!/usr/bin/python3
# creates a relay to a python script source file, acting as that file.
import sys
sys.path[0] = {0!r}.rpartition('/')[0]
python_script = {0!r}
with open(python_script, 'r') as fh:
    context = {{
        '__builtins__': __builtins__,
        '__doc__': None,
        '__file__': python_script,
        '__name__': __name__,
        '__package__': None,
    }}
    exec(compile(fh.read(), python_script, 'exec'), context)
"""


OUTSIDE = os.path.join(os.path.dirname(FOLDER), 'lockstep_nodes', 'waits_outside.py')
# A loop that calls a service until another thread has changed something.
CALLS = """import rospy
from std_srvs.srv import Empty, EmptyResponse
rospy.init_node('calls')
rospy.Service('nothing', Empty, lambda _request: EmptyResponse())
seen = []
rospy.Timer(rospy.Duration(0.02), seen.append, oneshot=True)
call = rospy.ServiceProxy('nothing', Empty)
while not seen:
    call()
print('%.9f seen' % rospy.get_time())
"""

# A loop that waits for a message that is latched, and so there at once each time, until it says something else.
LATCHED = """import rospy
from std_msgs.msg import String
rospy.init_node('latched')
said = rospy.Publisher('said', String, queue_size=1, latch=True)
said.publish('one')
rospy.Timer(rospy.Duration(0.5), lambda _event: said.publish('two'), oneshot=True)
while rospy.wait_for_message('said', String, timeout=1.0).data == 'one':
    pass
print('%.2f heard' % rospy.get_time())
"""


class LookingTest(Scenario, unittest.TestCase):
    """Loops without sleep see each change at its instant, and the run is repeatable."""

    programs = {'looking': ['looking.py', 'move_base:=/robot_0/move_base'], 'rival': ['rival.py']}
    until, settings = 30.0, {'fleet': [{'name': 'robot_0'}]}

    def test_they_go_on_at_the_instant_at_which_something_happens(self):
        self.assertEqual([line.split(None, 1)[1] for line in self.runs[0].printed('looking')],
                         ['heard', 'by a flag', 'by the state', 'by the time'])
        heard, flag, state, time = (float(line.split()[0]) for line in self.runs[0].printed('looking'))
        self.assertLess(heard, 1.1)
        # Both only look, so each wait ends at the callback, not at the next step of time.
        self.assertAlmostEqual(flag, heard + 2.0, places=9)
        self.assertAlmostEqual(state, flag + 2.0, places=9)
        self.assertTrue(state + 0.25 <= time <= state + 0.2511, (state, time))
        self.assertEqual(self.runs[0].printed('rival'), ["%.9f ['there', 'back']" % state])


class ExplorerTest(OwnFolder, unittest.TestCase):
    """Loops that look at variables: in a script, in its module, in a thread and in a relay of catkin's."""

    def test_they_go_on_exactly_where_they_do_nothing_but_look(self):
        relay = self.write('relay', RELAY.format(os.path.join(FOLDER, 'explorer.py')))
        runs = run_scenario({'explorer': ['explorer.py'], 'relay': [relay], 'finder': ['frontier_finder.py']},
                            until=17.5)
        assert_same(self, runs)
        # Frontiers come at 200 Hz from 2 s on, with a word after each 300th. A looking thread sees the end of another
        # one 10 ms later, or at the next event.
        self.assertEqual(runs[0].printed('explorer'), [
            '2.000000000 frontier 0.0', '3.495000000 come', '3.500000000 stopped', '16.995000000 heard'])
        self.assertEqual(runs[0].printed('relay'), runs[0].printed('explorer'))
        # They look for ever, but end with the run.
        self.assertEqual(runs[0].codes, {'explorer': 1, 'relay': 1, 'finder': 0})

    def test_they_go_on_exactly_where_functions_of_the_program_do_nothing_but_look(self):
        runs = run_scenario({'explorer': ['explorer.py', '_asks:=true'], 'finder': ['frontier_finder.py']}, until=10.0)
        assert_same(self, runs)
        self.assertEqual(runs[0].printed('explorer')[-1], '4.995000000 come')

    def test_a_loop_that_calls_a_service_until_the_world_changes_lets_time_go_on(self):
        run = run_programs({'calls': [self.write('calls.py', CALLS)]}, until=2.0)
        self.assertEqual((run.printed('calls'), run.state.not_repeatable_because), (['1.020000000 seen'], []))

    def test_a_loop_that_waits_for_what_is_there_at_once_lets_time_go_on(self):
        run = run_programs({'latched': [self.write('latched.py', LATCHED)]}, until=3.0)
        self.assertEqual((run.printed('latched'), run.state.not_repeatable_because), (['1.50 heard'], []))

    def test_they_go_on_with_a_label_where_they_may_compute(self):
        run = run_programs({'explorer': ['explorer.py', '_computes:=true'], 'finder': ['frontier_finder.py']},
                           until=10.0)
        self.assertEqual(run.printed('explorer')[-1], '4.995000000 come')
        with open(os.path.join(FOLDER, 'partner.py')) as script:
            line = 1 + script.read().splitlines().index('        while not self.has_spoken():')
        text = 'the loop in {}, line {}, went round 1,000,000 times without a wait'.format(
            os.path.join(FOLDER, 'partner.py'), line)
        self.assertEqual(len(run.state.not_repeatable_because), 1)
        self.assertIn(text, run.state.not_repeatable_because[0])
        self.assertEqual(len([warning for warning in run.logged('explorer', 'WARN') if text in warning]), 1)


class RestlessTest(unittest.TestCase):
    """Waits that take no time, and a thread that computes until a flag stops it."""

    def test_sleeps_of_no_length_and_questions_to_the_master_let_time_go_on(self):
        run = run_programs({'restless': ['restless.py', 'event,sleep,yield,parameter']}, until=20.0)
        *said, asked = run.printed('restless')
        self.assertEqual([line.split()[1] for line in said], ['event', 'sleep', 'yield', 'parameter'])
        for number, line in enumerate(said, 2):
            self.assertAlmostEqual(float(line.split()[0]), number, delta=0.02 * number)
        self.assertLess(int(asked.split()[1]), 1000)  # about a hundred steps of time
        self.assertEqual(list(run.state.not_repeatable_because), [])

    def test_a_thread_that_computes_until_it_is_told_to_stop_goes_on_with_a_label(self):
        run = run_programs({'restless': ['restless.py', 'work']}, until=20.0)
        self.assertEqual(run.codes, {'restless': 0}, run.outputs)
        label, = run.state.not_repeatable_because
        self.assertIn('restless.py, line 19, went round 10,000,000 times without a wait', label)


class OutsideTest(OwnFolder, unittest.TestCase):
    """Threads that wait for somebody outside: in a pipe, standard input, a FIFO, accept, a queue, and for a signal."""

    def test_who_waits_for_somebody_outside_holds_up_nobody_and_takes_turns_again_when_it_is_told(self):
        os.mkfifo(self.path('fifo'))
        run = run_programs({'waits': [OUTSIDE, self.path('fifo')]}, until=4.0)
        printed = run.printed('waits')
        self.assertEqual([line for line in printed if line[0].isdigit()],
                         ['%.9f' % second for second in range(2, 5)])
        self.assertEqual([line for line in printed if not line[0].isdigit()],
                         ['locked', 'told True, slept for 0.500000000', 'heard'])
        labels = ' '.join(run.state.not_repeatable_because)
        for call in ('assert os.read(reader, 1)', 'self._target(*self._args, **self._kwargs)',
                     'with open(sys.argv[1]) as fifo:', 'server.accept()', 'signal.pause()'):
            self.assertIn(call, labels)
        self.assertIn('waits for somebody outside for longer than 0.2 s of the wall clock', labels)


class TextsTest(unittest.TestCase):
    """Code that a program compiles, or loads from a file, itself."""

    def test_it_is_followed_as_the_rest(self):
        run = run_programs({'texts': ['mission_texts.py'], 'greeter': [
            shutil.which('rostopic'), 'pub', '-r', '2', 'greeting', 'std_msgs/String', 'data: hello']}, until=10.0)
        self.assertEqual(run.printed('texts'), [
            'log 2020-01-01 00:00:01,500 heard', 'mission 1.500000000 2020-01-01 00:00:01.500000', 'True',
            'plugin 2.000000000', '3 2 True', '[1] [1] [1] [1]', 'True'])
        labels = ' '.join(run.state.not_repeatable_because)
        self.assertIn("'/texts': mission.txt, line 7: goes through a set of objects", labels)
        self.assertIn("'/texts': os.getpid in ", labels)  # by way of email.utils


class TalkingTest(unittest.TestCase):
    """While rospy sends a message or a log line, no other thread gets the turn."""

    def test_a_callback_that_logs_and_publishes_is_not_interrupted(self):
        run = run_programs({'ledger': ['ledger.py'], 'clerk': ['clerk.py']}, until=5000.0, onlookers=['/notes'],
                           clock={'speed_limit': 200.0})
        self.assertEqual(run.outputs['ledger'].count('KeyError'), 0)
        self.assertEqual(run.printed('ledger'), ['job %d took 0.000000000 s' % number for number in range(3)])
        self.assertEqual(run.state.degraded_because, [])
        self.assertNotEqual(run.state.phase, 'zero_delay_loop')

    def test_it_does_not_matter_when_rosout_is_there(self):
        rosout = find_node('rosout', 'rosout')[0]
        runs = [run_programs({'accountant': ['accountant.py'], 'clerk': ['clerk.py']}, until=6.0, others=others,
                             clock={'speed_limit': 2.0})
                for others in ({'/rosout': ([rosout], 0.0)}, {'/rosout': ([rosout], 1.0)}, {})]
        assert_same(self, runs)
        self.assertEqual(runs[0].printed('accountant'), ['job %d took 0.000000000 s' % number for number in range(3)])
        self.assertEqual(runs[0].outputs['accountant'].count('KeyError'), 0)
