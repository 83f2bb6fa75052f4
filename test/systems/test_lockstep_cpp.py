"""roscpp nodes in lockstep (test/cpp_nodes), each test under a ROS master and a time master of its own.

Everything waits for events; GUARD [s, wall] only ends a test that would never end.
"""

import os
import signal
import subprocess
import sys
import time
import unittest

import rosgraph
import rospy
from lockstep_roscpp_run import take_name
from own_sockets import closed_connections
from std_msgs.msg import Time
from std_srvs.srv import Trigger
from warm import Loopback

from move_base_abstract.msg import TimeState

GUARD = 30.0
NS = 1000000000

# A node that does not take part.
CALLER = """
import rospy
from std_srvs.srv import SetBool
rospy.wait_for_service('/wait')
print(rospy.ServiceProxy('/wait', SetBool)(True).message, end='')
"""

# A node that publishes by the bytes of the protocol, and copies by ROS. argv: the folder of the tests; early or late:
# whether the listener gets copies before this node leaves.
GHOST = """
import struct, sys, time, xmlrpc.client
sys.path.insert(0, sys.argv[1])
import rosgraph, rospy
from lockstep_raw_client import RawClient, advertise, send
from std_msgs.msg import Time
from move_base_abstract_ros.lockstep.exchange.access import secret
rospy.init_node('ghost')
address = rospy.get_param('/time_master/lockstep_address')
ghost = RawClient(address).hello('/ghost', uri=rospy.get_node_uri(), secret=secret())
holder = RawClient(address).hello('/holder', secret=secret())
ticks = rospy.Publisher('/ticks', Time, queue_size=10)
listener = xmlrpc.client.ServerProxy(rosgraph.Master('/ghost').lookupNode('/listener'))
def publish(stamp):
    ticks.publish(rospy.Time(stamp))
    published.append(stamp)
    while sum(link[2] for topic, links in listener.getBusStats('/ghost')[1] if topic == '/ticks'
              for link in links) < len(published):
        time.sleep(0.01)
published = []
ghost.turn(next_ns=2 * 10 ** 9, items=advertise(1, '/ticks', 'std_msgs/Time', Time._md5sum))
holder.turn(next_ns=3 * 10 ** 9, items=advertise(1, '/said', 'std_msgs/Time', Time._md5sum))
while not ticks.get_num_connections():
    time.sleep(0.01)
grant = ghost.grant()
for stamp in (7, 8):
    if sys.argv[2] == 'early':
        publish(stamp)
ghost.report(grant, leaving=True, items=b''.join(send(1, struct.pack('<II', stamp, 0)) for stamp in (7, 8)))
holder.turn(next_ns=4 * 10 ** 9, items=send(1, struct.pack('<II', 1, 0)))
grant = holder.grant()  # the listener knows that /ghost has left
for stamp in (7, 8, 9):
    publish(stamp)
holder.report(grant, next_ns=5 * 10 ** 9)
holder.turn()
"""

SCRIPT = """
1000000000 0 first grant
1250000000 0 quarter
1500000000 0 half
1500000000 0 quarter
1500000000 0 once
1500000000 0 slept
1750000000 0 quarter
1750000000 0 slept until
1750000000 0 slept not
1750000000 0 at once
1750000000 1 gave way
2083333333 0 rate
2416666666 0 rate
2749999999 0 rate
3249999999 0 rate is late
3416666665 0 rate
3416666665 1 in gets a
3416666665 1 in gets b
3416666665 1 newest gets b
3416666665 1 in gets c
3416666665 1 newest gets c
3916666665 2 late gets k2
4416666665 0 later gets k2
4416666665 1 late gets k3
4416666665 1 later gets k3
4916666665 0 1 subscriber
4916666665 1 begins one
5416666665 0 ends one
5416666665 0 begins two
5916666665 0 ends two
5916666665 0 tick
5916666665 0 slept too long
6116666665 0 tick
6116666665 0 slept
6116666665 0 timer: lockstep: the period of a timer of /exact must be more than 0 s (a oneshot timer's may be 0), \
got 0.000000
6116666665 0 second: lockstep: node /exact has a Participant already; one per process is allowed
6116666665 0 spin: lockstep: spin of /exact was called in a callback; only sleep and service calls may
7116666665 0 timed out
""".strip().splitlines()


def output(child):
    with open(child.log_path, errors='replace') as log:
        return log.read()


def lines(child):
    """Return the lines that a node has printed, without roscpp's log."""
    return [line for line in output(child).splitlines() if line and '\x1b' not in line]


def wait_for(what, condition):
    deadline = time.monotonic() + GUARD
    while not condition():
        if time.monotonic() > deadline:
            raise AssertionError(f'not within {GUARD} s: {what}')
        time.sleep(0.01)


class LockstepCppTest(unittest.TestCase):
    def start(self, ros, *participants, **parameters):
        """Start a time master that waits for the participants."""
        return ros.run('time_master', 'time_master',
                       parameters=dict(parameters, mode='lockstep', participants=list(participants)))

    def assert_ends(self, child, code=0):
        self.assertEqual(child.process.wait(GUARD), code, output(child))

    def test_sleeps_timers_rates_topics_and_queues_are_exact(self):
        with Loopback() as ros:
            node = ros.run('lockstep_exact', 'exact')  # before the time master, for which it waits
            self.start(ros, '/exact')
            self.assert_ends(node)
            self.assertEqual(lines(node), SCRIPT)

    def test_two_play_ping_pong_with_thinking_time(self):
        common = dict(rounds=3, pause=0.25, verbose=True)
        with Loopback() as ros:
            self.start(ros, '/one', '/two')
            # The node that begins comes last in the order. Its first message goes to a subscriber that it does not
            # know yet, and is also latched. It must come exactly once.
            one = ros.run('lockstep_pingpong', 'one', parameters={'to': '/b', 'from': '/a', **common})
            two = ros.run('lockstep_pingpong', 'two', parameters={'begin': True, 'to': '/a', 'from': '/b', **common})
            self.assert_ends(one)
            self.assert_ends(two)
            self.assertEqual(lines(one)[:-1], ['1000000000 0', '1500000000 2', '2000000000 4'])
            self.assertEqual(lines(two)[:-1], ['1250000000 1', '1750000000 3', '2250000000 5'])

    def test_messages_of_one_instant_come_by_rank_and_then_by_name_in_natural_order(self):
        nodes = ['ticker_10', 'ticker_2', 'a_last', 'z_first']
        ranks = {'a_last': 2000, 'z_first': -5}
        with Loopback() as ros:
            self.start(ros, '/listener', *('/' + node for node in nodes))
            listener = ros.run('lockstep_listener', 'listener',
                               parameters=dict(topics=['/' + node for node in nodes], until=4.5))
            for node in nodes:
                parameters = dict(period=1.0, ticks=3, topic='/' + node)
                if node in ranks:
                    parameters['lockstep_rank'] = ranks[node]
                ros.run('lockstep_ticker', f'{node}', parameters=parameters)
            self.assert_ends(listener)  # although the others have left
            expected = [f'{second * NS} 1 /{node} {second * NS}' for second in (2, 3, 4)
                        for node in ('z_first', 'ticker_2', 'ticker_10', 'a_last')]
            self.assertEqual(lines(listener), expected)

    def test_services_between_participants(self):
        with Loopback() as ros:
            self.start(ros, '/client', '/server')
            client = ros.run('lockstep_service', 'client')
            ros.run('lockstep_service', 'server', parameters=dict(serve=True))
            self.assert_ends(client)
            self.assertEqual(lines(client), ['1250000000 nobody', '1750000000 waited', '2250000000 failed',
                                             '2750000000 waited', '2750000000 failed'])
            self.assertIn('service /wait of /server returned false', output(client))
            self.assertIn('a call of /nobody by /client failed: no participant offers it', output(client))

    def test_parameters_are_set_with_the_round_and_over_one_connection(self):
        count = 60
        with Loopback() as ros:
            master = self.start(ros, '/board', '/other', strict=True)
            board = ros.run('lockstep_board', 'board', parameters=dict(count=count))
            other = ros.run('lockstep_board', 'other', parameters=dict(looks=count + 1, asks='/by_hand'))
            self.assert_ends(board)
            said = [line for line in lines(board) if not line[0].isdigit()]
            self.assertEqual([line.split(':')[0] for line in said], 7 * ['refused'], said)
            self.assertIn('the value of /wall/nothing must have a type', said[0])
            seen = [line for line in lines(board) if line[0].isdigit()]
            self.assertEqual(seen, [self.board_at(k) for k in range(count)])
            hand = rosgraph.Master('/hand', master_uri=ros.uri)
            wait_for('the last question', lambda: hand.hasParam('/wall/has_asked'))
            self.assertEqual(lines(other), [self.board_at(k) for k in range(count + 1)])
            self.assertLess(closed_connections(ros.uri), count / 2)
            hand.setParam('/not_asked_for', 1)
            hand.setParam('/by_hand', 1)
            self.assertEqual(other.process.wait(GUARD), 1, output(other))
            self.assertIn('strict, and the run is not repeatable: parameter /by_hand was set or deleted by a program '
                          'that does not take part, and /other asks for it', output(other))
            self.assertNotIn('/not_asked_for', output(master))

    @staticmethod
    def board_at(k):
        """Return the line that all nodes print after ``k`` rounds."""
        return '%d %d %s exact' % (NS + k * NS // 10, k, '<&> \u00e4' if k % 3 else '-')

    def test_the_others_go_on_when_one_is_killed(self):
        with Loopback() as ros:
            self.start(ros, '/listener', '/doomed', speed_limit=1.0)
            listener = ros.run('lockstep_listener', 'listener', parameters=dict(until=60.5))
            doomed = ros.run('lockstep_ticker', 'doomed')
            wait_for('a tick', lambda: lines(listener))
            os.kill(doomed.pid, signal.SIGKILL)
            doomed.process.wait(GUARD)
            subprocess.run(['rosservice', 'call', '/time_master/set_factor', '0.0'], env=ros.environment, timeout=GUARD,
                           check=True, stdout=subprocess.DEVNULL)
            self.assert_ends(listener)
            ticks = lines(listener)
            self.assertLess(len(ticks), 59)
            self.assertEqual(ticks, [f'{second * NS} 1 /ticks {second * NS}' for second in range(2, len(ticks) + 2)])

    def test_a_node_ends_with_its_time_master_whether_that_is_killed_or_ends(self):
        for number in (signal.SIGKILL, signal.SIGTERM):
            with Loopback() as ros:
                self.check_end(ros, number)

    def check_end(self, ros, number):
        master = self.start(ros, '/ticker', '/listener')
        ticker = ros.run('lockstep_ticker', 'ticker')
        listener = ros.run('lockstep_listener', 'listener', parameters=dict(until=1e9))
        wait_for('a tick', lambda: lines(listener))
        os.kill(master.pid, number)
        self.assert_ends(ticker, 1)  # although its main function returns 0
        self.assertRegex(output(ticker), 'FATAL.*the run is over for /ticker')
        self.assert_ends(listener, 1)  # its sleep did not end normally

    def test_a_node_whose_name_is_taken_says_so_and_ends_with_an_error(self):
        with Loopback() as ros:
            self.start(ros, '/ticker', '/listener', speed_limit=20.0)
            ticker = ros.run('lockstep_ticker', 'ticker')
            listener = ros.run('lockstep_listener', 'listener', parameters=dict(until=1e9))
            wait_for('a tick', lambda: lines(listener))
            take_name(ros, '/ticker')
            self.assert_ends(ticker, 1)  # although its main function returns 0
            self.assertRegex(output(ticker), 'FATAL.*/ticker: another node of its name has taken its place')

    def test_sigint_ends_a_node_and_nobody_else(self):
        with Loopback() as ros:
            master = self.start(ros, '/ticker', '/listener', speed_limit=20.0)
            ticker = ros.run('lockstep_ticker', 'ticker')
            listener = ros.run('lockstep_listener', 'listener', parameters=dict(until=40.5))
            wait_for('a tick', lambda: lines(listener))
            os.kill(ticker.pid, signal.SIGINT)
            self.assert_ends(ticker)
            self.assert_ends(listener)
            self.assertIsNone(master.process.poll())

    def test_on_the_scaled_clock_the_error_names_the_mode(self):
        with Loopback() as ros:
            ros.set_param('/time_master/mode', 'scaled')
            node = ros.run('lockstep_exact', 'exact')
            self.assert_ends(node, 3)
            self.assertIn("/time_master/mode is 'scaled', not 'lockstep'", output(node))

    def test_a_bad_rank_is_refused_with_its_name(self):
        with Loopback() as ros:
            node = ros.run('lockstep_listener', 'listener', parameters=dict(lockstep_rank='first'))
            self.assertNotEqual(node.process.wait(GUARD), 0)
            self.assertRegex(output(node), 'parameter /listener/lockstep_rank: got .*first.*; allowed: a whole number')

    def test_nodes_that_do_not_take_part_hear_all_and_are_heard_with_a_label(self):
        with Loopback() as ros:
            ros.adopt()
            rospy.init_node('outside', disable_signals=True)
            self.addCleanup(rospy.signal_shutdown, 'the test is over')
            heard, states = [], []
            ticks = rospy.Subscriber('/ticks', Time, lambda message: heard.append(message.data.to_nsec()))
            rospy.Subscriber('/time_master/state', TimeState, states.append)
            said = rospy.Publisher('/said', Time, queue_size=1)
            self.start(ros, '/ticker', '/listener', start_paused=True)
            ticker = ros.run('lockstep_ticker', 'ticker', parameters=dict(period=1.0, ticks=50))
            listener = ros.run('lockstep_listener', 'listener', parameters=dict(until=60.0, topics=['/said', '/ticks']))
            wait_for('the connections', lambda: ticks.get_num_connections() and said.get_num_connections())
            self.assertTrue(states[-1].repeatable, states[-1])
            self.assert_not_on_clock(ros, '/ticker', '/listener')
            said.publish(rospy.Time(5))
            wait_for('the message', lambda: lines(listener))
            self.assertEqual(lines(listener), ['1000000000 2 /said 5000000000'])
            label = f'a message on /said came from {rospy.get_name()}, which does not take part'
            wait_for('the label', lambda: any(label in text for text in states[-1].not_repeatable_because))
            self.assertFalse(states[-1].repeatable)
            rospy.ServiceProxy('/time_master/resume', Trigger)()
            self.assert_ends(listener)
            self.assertEqual(lines(listener)[1:], [f'{second * NS} 1 /ticks {second * NS}' for second in range(2, 52)])
            wait_for('all ticks', lambda: len(heard) == 50)
            self.assert_ends(ticker)
            self.assertEqual(lines(ticker)[-1], '1 listeners')  # an onlooker is not counted
            self.assertEqual(heard, [second * NS for second in range(2, 52)])

    def test_a_copy_that_comes_after_its_sender_has_left_is_no_message_from_outside(self):
        # A connection that has brought copies of a participant brings nothing else; another one brings new messages.
        for when, stamps, labels in (('early', [7, 8, 1], 0), ('late', [7, 8, 1, 9], 2)):
            with Loopback() as ros:
                master = self.start(ros, '/ghost', '/holder', '/listener')
                listener = ros.run('lockstep_listener', 'listener', parameters=dict(
                    until=9.0, topics=['/said', '/ticks']))
                ros.spawn('/ghost', [sys.executable, '-c', GHOST, os.path.dirname(os.path.abspath(__file__)), when])
                self.assert_ends(listener)
                self.assertEqual([int(line.split()[3]) // NS for line in lines(listener)], stamps, when)
                self.assertEqual(output(master).count('the run is not repeatable'), labels, output(master))

    def test_a_service_answers_nodes_that_do_not_take_part_and_may_sleep_in_it(self):
        with Loopback() as ros:
            self.start(ros, '/server')
            ros.run('lockstep_service', 'server', parameters=dict(serve=True))
            command = [sys.executable, '-c', CALLER]
            ran = subprocess.run(command, env=ros.environment, stdout=subprocess.PIPE, timeout=GUARD, check=True)
            self.assertEqual(ran.stdout, b'waited')

    def assert_not_on_clock(self, ros, *nodes):
        _, subscribers, _ = rosgraph.Master('/test', master_uri=ros.uri).getSystemState()
        listening = [name for topic, names in subscribers if topic == '/clock' for name in names]
        self.assertFalse(set(nodes) & set(listening), listening)


class CoordinatorTest(unittest.TestCase):
    """A coordinator in C++ with a fleet in Python."""

    def run_once(self, log):
        robots = [dict(name='robot', count=4, step_x=1.0)]
        with Loopback() as ros:
            ros.run('time_master', 'time_master',
                    parameters=dict(mode='lockstep', participants=['/fleet', '/coordinator'], event_log=log))
            ros.run('fleet', 'fleet', parameters=dict(robots=robots))
            coordinator = ros.run('lockstep_coordinator_cpp', 'coordinator',
                                  parameters=dict(robots=4, goals=120, seed=11, patient=True))
            self.assertEqual(coordinator.process.wait(GUARD), 0, output(coordinator))
            self.assertIn('120 goals', output(coordinator))
            self.assertIn('all results are in', output(coordinator))
        with open(log, 'rb') as written:
            return written.read()

    def test_a_run_can_be_repeated_to_the_byte(self):
        with Loopback() as ros:
            first = self.run_once(os.path.join(ros.log_dir, 'first.jsonl'))
            second = self.run_once(os.path.join(ros.log_dir, 'second.jsonl'))
        self.assertGreater(first.count(b'\n'), 240)
        for status in (b'SUCCEEDED', b'PREEMPTED'):
            self.assertIn(status, first)
        self.assertEqual(first, second)
