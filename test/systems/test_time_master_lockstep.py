"""The time master in lockstep, by its protocol, byte by byte: start, rounds, messages, gate, modes and /clock.

Everything waits for events; GUARD [s, wall] only ends a test that would never end.
"""

import time

import lockstep_raw_client as raw
import rospy
from lockstep_run import NEVER, SECOND, START, LockstepCase, Messages, wait_for
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Float64
from std_srvs.srv import Trigger

from move_base_abstract.srv import AcquireHold, ReleaseHold, RunUntil, SetFactor, SetMode, Step

LAUNCH_FILE = """
<launch>  <!-- the time master in lockstep, by its protocol, byte by byte: start, rounds, gate, modes, /clock -->
  <param name="/use_sim_time" value="true"/>
</launch>
"""


class LockstepTest(LockstepCase):
    # ---- start ----

    def test_the_clock_starts_when_all_named_participants_are_there_and_says_whom_it_waits_for(self):
        self.start(participants=['a', '/ns/b'], start_time=5.0)
        first = self.join('/a')
        state = self.state.wait('b missing', lambda state: [one.name for one in state.waiting_for] == ['/ns/b'])
        self.assertEqual((state.mode, state.phase, state.waiting_for[0].owes),
                         ('lockstep', 'waiting_for_participants', 'its HELLO'))
        self.assert_no_grant(first)
        self.assertEqual(self.times(), [], 'nothing is published before the start')
        second = self.join('/ns/b')
        for client in (first, second):
            self.assertEqual(client.grant()[1:], (5 * SECOND, 0, []))
        self.clock.wait('the start', lambda message: message.clock.to_nsec() == 5 * SECOND)
        state = self.state.wait('the start', lambda state: state.phase != 'waiting_for_participants')
        self.assertTrue(state.repeatable)

    def test_without_names_it_starts_when_nobody_new_has_come_for_a_while_and_is_labelled(self):
        self.start(settle=3.0)
        first = self.join('/a')
        begin = time.monotonic()
        second = self.join('/b')
        second.turn()
        self.assertGreaterEqual(time.monotonic() - begin, 3.0)  # a busy machine can only make it longer
        self.assertEqual(first.turn().time_ns, START)
        state = self.state.wait('the start', lambda state: state.phase == 'idle')
        self.assertFalse(state.repeatable)
        self.assertIn('no participants are named', state.not_repeatable_because[0])

    # ---- rounds ----

    # ---- pause, step, run until, speed limit ----

    def test_pause_step_run_until_and_resume(self):
        self.start(participants=['/a'], start_paused=True)
        client = self.join('/a')
        client.turn(next_ns=2 * SECOND)
        self.assertTrue(self.state.wait('paused', lambda state: state.phase == 'paused').paused)
        self.assert_no_grant(client)
        answer = self.call('step', Step, rospy.Duration(1))
        self.assertEqual((answer.success, answer.target.to_nsec()), (True, 2 * SECOND))
        self.assertEqual(client.turn(next_ns=3 * SECOND)[1:3], (2 * SECOND, 0))
        self.state.wait('paused', lambda state: state.phase == 'paused' and state.sim_time.to_nsec() == 2 * SECOND)
        self.assertTrue(self.call('run_until', RunUntil, rospy.Time(4)).success)
        self.assertEqual(client.turn(next_ns=5 * SECOND).time_ns, 3 * SECOND)
        self.state.wait('the target', lambda state: state.paused and state.sim_time.to_nsec() == 4 * SECOND)
        self.clock.wait('the target', lambda message: message.clock.to_nsec() == 4 * SECOND)
        self.assertTrue(self.call('resume', Trigger).success)
        self.assertEqual(client.turn(next_ns=6 * SECOND).time_ns, 5 * SECOND)
        grant = client.grant()
        self.assertTrue(self.call('pause', Trigger).success)
        client.report(grant, next_ns=grant.time_ns)
        self.assertEqual(client.turn(next_ns=7 * SECOND)[1:3], (6 * SECOND, 1), 'a pause lets the instant be finished')
        self.assert_no_grant(client)
        answer = self.call('run_until', RunUntil, rospy.Time(1))
        self.assertFalse(answer.success)

    def test_the_speed_limit_is_set_by_parameter_and_service(self):
        self.start(participants=['/a'], speed_limit=10.0)
        client = self.join('/a')
        client.turn(next_ns=2 * SECOND)
        begin = time.monotonic()
        client.turn(next_ns=102 * SECOND)
        self.assertGreaterEqual(time.monotonic() - begin, 0.08)
        self.state.wait('limited', lambda state: state.phase == 'limited' and state.wanted_factor == 10.0)
        self.assertTrue(self.call('set_factor', SetFactor, 1e6).success)
        self.assertEqual(client.turn(next_ns=10 ** 6 * SECOND).time_ns, 102 * SECOND)
        answer = self.call('set_factor', SetFactor, 0.0)
        self.assertEqual((answer.success, answer.message), (True, 'no speed limit'))
        self.assertEqual(client.turn().time_ns, 10 ** 6 * SECOND)
        self.assertFalse(self.call('set_factor', SetFactor, -1.0).success)

    def publisher_of_factors(self):
        """Return a publisher on /sim_time_factor, as existing studies have, when the time master listens to it."""
        publisher = rospy.Publisher('/sim_time_factor', Float64, queue_size=10)
        self.addCleanup(publisher.unregister)
        wait_for('the time master to listen', publisher.get_num_connections)
        return publisher

    def test_a_studys_sim_time_factor_is_noted_once_and_limits_nothing(self):
        self.start(participants=['/a'])
        client = self.join('/a')
        publisher = self.publisher_of_factors()
        for factor in (1.0, 1.0, float('nan')):
            publisher.publish(factor)
        self.wait_for_output(f'/sim_time_factor from {rospy.get_name()} has no effect in lockstep')
        client.turn(next_ns=10 ** 6 * SECOND)
        self.assertEqual(client.turn().time_ns, 10 ** 6 * SECOND)  # at 1x it would take eleven days
        client.leave()
        self.state.wait('nobody', lambda state: not state.participants)
        self.assertTrue(self.call('set_mode', SetMode, 'scaled').success)
        publisher.publish(33.0)  # in this mode it has an effect, and the messages before it are handled
        self.state.wait('the factor', lambda state: state.wanted_factor == 33.0)
        limits = {state.wanted_factor for state in self.state.messages if state.mode == 'lockstep'}
        self.assertEqual(limits, {0.0})
        notes = [line for line in self.output().splitlines() if '/sim_time_factor' in line]
        self.assertEqual(len(notes), 1, notes)
        self.assertIn('sim_time_factor_is_limit', notes[0])

    def test_sim_time_factor_sets_the_speed_limit_where_a_parameter_says_so(self):
        self.start(participants=['/a'], sim_time_factor_is_limit=True)
        self.publisher_of_factors().publish(20.0)
        self.state.wait('the limit', lambda state: state.wanted_factor == 20.0)

    def test_holds_are_refused_and_the_answer_says_what_serves_instead(self):
        self.start()
        answer = self.call('hold', AcquireHold, 'me', 1.0)
        self.assertFalse(answer.success)
        self.assertIn('charge', answer.message)
        self.assertFalse(self.call('release', ReleaseHold, 'me').success)

    # ---- mode and parameters ----

    def test_the_mode_changes_while_nobody_takes_part_and_time_does_not_go_back(self):
        self.start(mode='scaled', participants=['/a'], factor=100.0)
        self.clock.wait('some time', lambda message: message.clock.to_nsec() > 2 * SECOND)
        self.assertFalse(self.call('set_factor', SetFactor, 0.0).success, '0 is for lockstep only')
        self.assertFalse(self.master.hasParam('/time_master/lockstep_address'))
        answer = self.call('set_mode', SetMode, 'lockstep')
        self.assertTrue(answer.success, answer.message)
        self.assertEqual(self.master.getParam('/time_master/mode'), 'lockstep')
        self.address = self.address_now()
        client = self.join('/a')
        begin = client.turn(next_ns=10 ** 5 * SECOND).time_ns
        client.turn()
        answer = self.call('set_mode', SetMode, 'scaled')
        self.assertFalse(answer.success)
        self.assertIn('/a', answer.message)
        client.leave()
        self.state.wait('nobody', lambda state: not state.participants)
        self.assertTrue(self.call('set_mode', SetMode, 'scaled').success)
        self.assertEqual(client.end(), 'the mode is changed to scaled')
        self.assertFalse(self.master.hasParam('/time_master/lockstep_address'))
        self.clock.wait('time going on', lambda message: message.clock.to_nsec() > (10 ** 5 + 1) * SECOND)
        times = self.times()
        self.assertEqual(times, sorted(times))
        self.assertGreater(begin, 2 * SECOND)

    def test_the_mode_does_not_change_while_somebody_holds_the_clock_or_to_anything_else(self):
        self.start(mode='scaled')
        self.assertTrue(self.call('hold', AcquireHold, 'me', 60.0).success)
        answer = self.call('set_mode', SetMode, 'lockstep')
        self.assertFalse(answer.success)
        self.assertIn('holders are: me', answer.message)
        self.assertIn("got 'fast'", self.call('set_mode', SetMode, 'fast').message)
        self.assertIn('already', self.call('set_mode', SetMode, 'scaled').message)

    def test_bad_parameters_are_fatal_and_name_key_value_and_what_is_allowed(self):
        cases = ((dict(mode='fast'), 'mode must be lockstep or scaled', "got 'fast'"),
                 (dict(participants='a'), 'participants must be a list of texts', "got 'a'"),
                 (dict(participants=['a', '/a']), 'participants must name each node once', "'/a' twice"),
                 (dict(participants=['a b']), 'participants must be a list of node names', "'a b'"),
                 (dict(settle=-1.0), 'settle must be from 0 to 3600 s', 'got -1'),
                 (dict(speed_limit=0.001), 'speed_limit must be from 0.01 to 1000000', 'got 0.001'),
                 (dict(on_silence='shout'), 'on_silence must be drop or wait', "got 'shout'"),
                 (dict(on_death=1), 'on_death must be a text', "got '1'"),
                 (dict(max_microsteps=0), 'max_microsteps must be from 1 to 100000000', 'got 0'),
                 (dict(max_microsteps=2.5), 'max_microsteps must be a whole number', 'got'),
                 (dict(lockstep_port=70000), 'lockstep_port must be from 0 to 65535', 'got 70000'),
                 (dict(end_at=0.5), 'end_at must be 0, or not before start_time', 'got 0.5'),
                 (dict(end_with=['a b']), 'end_with must be a list of node names', "'a b'"),
                 (dict(strict='yes'), 'strict must be true or false', "got 'yes'"),
                 (dict(event_log='/tmp/log.txt'), 'event_log must end in .jsonl or .csv', "got '/tmp/log.txt'"),
                 (dict(event_log='/none/log.csv'), 'event_log must be a path that can be written', 'No such file'))
        for parameters, *texts in cases:
            self.launch(**{'mode': 'lockstep', **parameters})
            self.assertEqual(self.process.wait(raw.GUARD), 1, self.output())
            for text in ['FATAL', '/time_master/', *texts]:
                self.assertIn(text, self.output())

    # ---- /clock ----

    def test_clock_is_latched_in_order_capped_and_repeated_and_ends_at_the_newest_time(self):
        self.start(participants=['/a'], max_clock_rate=100.0, repeat_rate=10.0)
        client = self.join('/a')
        self.clock.wait('the first time', lambda message: message.clock.to_nsec() == START)
        begin = time.monotonic()
        for _ in range(3000):
            grant = client.turn(next_ns=NEVER if _ == 2999 else START + _ * SECOND)
        last = self.clock.wait('the last time', lambda message: message.clock.to_nsec() == grant.time_ns)
        wall = time.monotonic() - begin
        times = self.times()
        self.assertEqual(times[0], START)
        self.assertEqual(times, sorted(times))
        self.assertLessEqual(len(times), wall * 100.0 + 3)
        self.assertEqual(last._connection_header['latching'], '1')
        count = len(self.clock.messages)
        wait_for('three repetitions', lambda: len(self.clock.messages) >= count + 3)
        late = Messages('/clock', Clock)
        self.assertEqual(late.wait('any', lambda message: True).clock.to_nsec(), grant.time_ns)
        late.close()
