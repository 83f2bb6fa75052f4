"""The running time master: topics, services, holds, and other publishers of /clock.

Everything waits for events; GUARD [s, wall] only ends a test that would never end.
"""

import math
import os
import signal
import subprocess
import sys
import time
import unittest

import psutil
import rospy
from own_sockets import listening_addresses, pid_of
from robot_harness import Record
from rosgraph_msgs.msg import Clock, Log
from std_msgs.msg import Float64
from std_srvs.srv import Trigger
from waiting import GUARD, wait_for

from move_base_abstract.msg import TimeState
from move_base_abstract.srv import (
    AcquireHold,
    RecentMessages,
    ReleaseHold,
    RunUntil,
    SetFactor,
    SetLooking,
    Step,
    StopWhen,
)
from move_base_abstract_ros.loopback import find_executable
from move_base_abstract_ros.time_master_client import TimeMasterClient, TimeMasterError

LAUNCH_FILE = """
<launch>  <!-- a running time master: topics, services, holds, and warnings; it owns /clock -->
  <include file="$(find move_base_abstract)/launch/time_master.launch">
    <arg name="busy_factor" value="0.5"/>
  </include>
</launch>
"""
OWN_NODE = 'time_master_test'

BUSY_FACTOR = 0.5  # as in time_master.test
LISTENER = """
import rospy, sys
rospy.init_node(sys.argv[1])
while rospy.get_rostime().is_zero():
    pass
print('listening', flush=True)
rospy.spin()
"""
BAD_FACTORS = (0.0, -1.0, 0.001, 1e7, math.nan, math.inf, -math.inf)

HOLDER = """
import rospy, time
from move_base_abstract_ros.time_master_client import TimeMasterClient
rospy.init_node('doomed', disable_signals=True)
with TimeMasterClient().hold('doomed', 2.0):
    print('holding', flush=True)
    time.sleep(600)
"""


class Marked(Record):
    """A record of which one asks what came after a mark."""

    def mark(self):
        """Return the number of messages so far, for wait() and since()."""
        return len(self.messages)

    def since(self, mark):
        return self.messages[mark:]

    def wait(self, what, wanted, mark=0):
        """Return the first message after ``mark`` for which wanted(message) is true."""
        return self.wait_for(wanted, what, mark)

    def wait_for_count(self, count, mark):
        self.wait_for(lambda message: True, f'message number {count}', mark + count - 1)
        return self.since(mark)


class TimeMasterTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.clock = Marked('/clock', Clock)
        cls.state = Marked('/time_master/state', TimeState)
        cls.log = Marked('/rosout', Log)
        cls.client = TimeMasterClient()
        cls.clock.wait('any time', lambda message: True)
        cls.state.wait('any state', lambda message: True)

    def setUp(self):
        self.client.set_factor(1.0)
        self.client.resume()

    def call(self, service, kind, *arguments):
        name = '/time_master/' + service
        rospy.wait_for_service(name, GUARD)
        return rospy.ServiceProxy(name, kind)(*arguments)

    def times(self, mark=0):
        return [message.clock.to_nsec() for message in self.clock.since(mark)]

    # ---- /clock ----

    def test_clock_is_latched_and_starts_at_one_second_or_later(self):
        late = Marked('/clock', Clock)
        first = late.wait('any time', lambda message: True)
        self.assertEqual(first._connection_header['latching'], '1')
        self.assertGreaterEqual(self.times()[0], 10 ** 9)

    def test_clock_never_goes_back_through_all_commands(self):
        mark = self.clock.mark()
        for factor in (1000.0, 0.01, 50.0):
            self.client.set_factor(factor)
            self.client.pause()
            self.client.step(0.5)
            self.client.resume()
            with self.client.hold('test', 5.0):
                self.clock.wait_for_count(5, self.clock.mark())
        times = self.times(mark)
        self.assertEqual(times, sorted(times))

    def test_pause_repeats_the_present_until_resume(self):
        self.client.pause()
        last = self.clock.wait_for_count(3, self.clock.mark())[-1].clock.to_nsec()
        mark = self.clock.mark()
        self.clock.wait_for_count(5, mark)
        self.assertEqual(set(self.times(mark)), {last})
        self.assertTrue(self.state.wait('paused', lambda state: state.paused, 0).paused)
        self.client.resume()
        self.clock.wait('a later time', lambda message: message.clock.to_nsec() > last)

    # ---- factor ----

    def test_sim_time_factor_topic_sets_the_factor(self):
        publisher = rospy.Publisher('/sim_time_factor', Float64, queue_size=1, latch=True)
        mark = self.state.mark()
        publisher.publish(20.0)
        self.state.wait('factor 20', lambda state: state.wanted_factor == 20.0, mark)
        publisher.unregister()

    def test_state_tells_wanted_effective_and_achieved_factor(self):
        mark = self.state.mark()
        self.assertTrue(self.call('set_factor', SetFactor, 50.0).success)
        state = self.state.wait('factor 50', lambda state: state.wanted_factor == 50.0, mark)
        self.assertEqual((state.mode, state.effective_factor, state.busy_factor), ('scaled', 50.0, BUSY_FACTOR))
        self.state.wait('achieved 50', lambda state: abs(state.achieved_factor - 50.0) < 0.5, mark)

    def test_bad_factors_on_the_topic_are_refused_with_the_sender_named(self):
        publisher = rospy.Publisher('/sim_time_factor', Float64, queue_size=20)
        wait_for('a connection', publisher.get_num_connections)
        mark, states = self.log.mark(), self.state.mark()
        for bad in BAD_FACTORS:
            publisher.publish(bad)
        publisher.publish(3.0)  # handled after the others
        self.state.wait('factor 3', lambda state: state.wanted_factor == 3.0, states)
        warned = self.log.wait('a warning', lambda log: '/sim_time_factor from' in log.msg, mark)
        self.assertIn(rospy.get_name(), warned.msg)
        self.assertEqual({state.wanted_factor for state in self.state.since(states)} - {1.0, 3.0}, set())
        publisher.unregister()

    # ---- step and run until ----

    def at_rest(self):
        """Return the time on /clock as soon as it does not change; messages from before may still be under way."""
        mark = self.clock.mark()
        while True:
            last, now = self.clock.wait_for_count(2, mark)[:2]
            if last.clock == now.clock:
                return now.clock
            mark += 1

    def end_of(self, target):
        """Wait until the time master is paused at ``target``; return the last time on /clock."""
        self.state.wait('the target', lambda state: state.paused and state.sim_time == target)
        return self.at_rest()

    def test_step_ends_exactly_and_paused_at_any_factor(self):
        for factor in (1.0, 77.7, 1e4):
            self.client.set_factor(factor)
            self.client.pause()
            before = self.at_rest()
            answer = self.call('step', Step, rospy.Duration(0, 123456789))
            self.assertTrue(answer.success, answer.message)
            self.assertEqual(answer.target, before + rospy.Duration(0, 123456789))
            self.assertEqual(self.end_of(answer.target), answer.target)

    def test_run_until_ends_exactly_and_tells_its_target(self):
        self.client.set_factor(10.0)
        target = self.clock.wait_for_count(1, self.clock.mark())[-1].clock + rospy.Duration(5, 1)
        mark = self.state.mark()
        self.assertTrue(self.call('run_until', RunUntil, target).success)
        self.state.wait('the target', lambda state: state.run_until == target, mark)
        self.client.wait_until(target, GUARD)
        self.assertEqual(self.end_of(target), target)

    # ---- holds ----

    def test_what_a_debugger_asks_for_is_refused_and_the_answer_says_what_serves_instead(self):
        for name, kind, instead in (('stop_when', StopWhen, 'use pause, step or run_until'),
                                    ('recent', RecentMessages, 'use rostopic echo'),
                                    ('looking', SetLooking, 'attach a debugger')):
            answer = rospy.ServiceProxy('/time_master/' + name, kind)()
            self.assertFalse(answer.success)
            self.assertIn('{}: only in lockstep'.format(name), answer.message)
            self.assertIn(instead, answer.message)
            self.assertIn('rosrun move_base_abstract debug', answer.message)

    def test_several_holders_keep_the_clock_busy_until_the_last_lets_go(self):
        self.client.set_factor(10.0)
        mark = self.state.mark()
        self.assertTrue(self.call('hold', AcquireHold, 'b', 30.0).success)
        self.assertTrue(self.call('hold', AcquireHold, 'a', 30.0).success)
        state = self.state.wait('two holders', lambda state: len(state.holds) == 2, mark)
        self.assertEqual([hold.holder for hold in state.holds], ['a', 'b'])
        self.assertEqual((state.wanted_factor, state.effective_factor), (10.0, BUSY_FACTOR))
        self.assertTrue(self.call('release', ReleaseHold, 'b').success)
        state = self.state.wait('one holder', lambda state: len(state.holds) == 1, self.state.mark())
        self.assertEqual(state.effective_factor, BUSY_FACTOR)
        again = self.call('release', ReleaseHold, 'b')
        self.assertFalse(again.success)
        self.assertIn('holders are: a', again.message)
        self.assertTrue(self.call('release', ReleaseHold, 'a').success)
        self.state.wait('factor 10', lambda state: state.effective_factor == 10.0, self.state.mark())

    def test_a_holder_that_dies_is_released_and_named_in_the_log(self):
        mark = self.log.mark()
        process = subprocess.Popen([sys.executable, '-c', HOLDER], stdout=subprocess.PIPE, text=True)
        try:
            self.assertEqual(process.stdout.readline(), 'holding\n')
        finally:
            process.kill()
            process.wait()
            process.stdout.close()
        self.log.wait('the holder', lambda log: log.level == Log.WARN and "hold by 'doomed' timed out" in log.msg, mark)
        self.state.wait('no holder', lambda state: not state.holds, self.state.mark())

    def test_a_node_that_is_killed_is_told_and_one_that_ends_is_not(self):
        for name, end in (('ends_well', signal.SIGTERM), ('is_killed', signal.SIGKILL)):
            process = subprocess.Popen([sys.executable, '-c', LISTENER, name], stdout=subprocess.PIPE, text=True)
            try:
                self.assertEqual(process.stdout.readline(), 'listening\n')
            finally:
                process.send_signal(end)
                process.wait()
                process.stdout.close()
        found = "'/is_killed' died (found at "
        state = self.state.wait('a death', lambda state: found in ''.join(state.degraded_because))
        self.assertNotIn('/ends_well', ''.join(state.degraded_because))
        self.log.wait('a death', lambda log: log.level == Log.ERROR and "'/is_killed' died" in log.msg)

    # ---- a time master that did not run for a while ----

    def test_time_does_not_leap_over_what_a_stopped_time_master_slept(self):
        factor = 100.0
        self.client.set_factor(factor)
        mark, log = self.clock.mark(), self.log.mark()
        master = psutil.Process(pid_of('/time_master'))
        master.suspend()
        try:
            time.sleep(2.0)  # the tested pause, not a wait for anything
        finally:
            master.resume()
        self.log.wait('a warning', lambda line: line.level == Log.WARN and 'did not run for a while' in line.msg, log)
        self.clock.wait_for_count(10, self.clock.mark())
        times = self.times(mark)
        # A gap counts for at most 0.25 s, and two advances may lie between two messages.
        self.assertLessEqual(max(b - a for a, b in zip(times, times[1:])), 2 * 0.25 * factor * 1e9)

    def test_it_listens_on_the_announced_address_only(self):
        self.assertEqual(listening_addresses(pid_of('/time_master')), {os.environ['ROS_IP']})

    def test_the_clients_hold_is_released_when_its_block_raises(self):
        states = self.state.mark()
        with self.assertRaises(ZeroDivisionError):
            with self.client.hold('raiser', 60.0):
                self.state.wait('the hold', lambda state: bool(state.holds), states)
                raise ZeroDivisionError
        self.state.wait('no hold', lambda state: not state.holds, self.state.mark())

    def test_the_client_raises_with_the_time_masters_text(self):
        with self.assertRaisesRegex(TimeMasterError, 'factor must be from 0.01'):
            self.client.set_factor(0)
        with self.assertRaisesRegex(TimeMasterError, 'must be more than 0'):
            self.client.step(-1.0)
        with self.assertRaisesRegex(TimeMasterError, 'is a time master running there'):
            TimeMasterClient('/nowhere', connect_timeout=0.1).pause()

    def test_the_client_rounds_seconds_to_the_nanosecond(self):
        self.client.pause()
        before = self.clock.wait_for_count(3, self.clock.mark())[-1].clock
        self.assertEqual(self.client.step(0.29), before + rospy.Duration(0, 290000000))

    # ---- two publishers of /clock ----

    def test_a_second_time_master_names_the_first_and_exits(self):
        for name in ('other_master', 'time_master'):
            process = subprocess.run([find_executable('time_master'), f'__name:={name}'], check=False, timeout=GUARD,
                                     text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
            self.assertEqual(process.returncode, 1, process.stdout)
            self.assertIn('/time_master', process.stdout)
            self.assertIn('FATAL', process.stdout)
        self.clock.wait_for_count(2, self.clock.mark())
        self.assertTrue(self.call('pause', Trigger).success)

    def test_another_publisher_of_clock_is_named_and_forgotten_when_silent(self):
        self.client.pause()
        present = self.clock.wait_for_count(3, self.clock.mark())[-1]
        logs, states = self.log.mark(), self.state.mark()
        publisher = rospy.Publisher('/clock', Clock, queue_size=1, latch=True)
        publisher.publish(present)  # the same time, so that this process sees no jump
        name = rospy.get_name()
        self.state.wait('the other', lambda state: state.other_clock_publishers == [name], states)
        self.log.wait('its name', lambda log: log.level == Log.ERROR and name + ' publishes /clock' in log.msg, logs)
        publisher.unregister()
        self.state.wait('nobody else', lambda state: not state.other_clock_publishers, self.state.mark())
