"""Lockstep over a network: ROS master and time master in one network namespace, participants in another.

The tests make and remove two namespaces with a cable (veth) between them. Without the right to make them, the tests are
skipped with a message.
"""

import os
import subprocess
import sys
import tempfile
import unittest

from night import times
from own_folder import events_of
from own_nodes import NODES
from waiting import GUARD
from warm import Loopback

from move_base_abstract_ros.loopback import find_executable

HOME, AWAY = '10.213.7.1', '10.213.7.2'
LEAPS = 500
PORT = 11311
SIM_TIME = """
import sys, time, rosgraph
while not rosgraph.is_master_online(sys.argv[1]):
    time.sleep(0.05)
rosgraph.Master('/setting', master_uri=sys.argv[1]).setParam('/use_sim_time', True)
"""
FOREIGN = os.path.join(NODES, 'foreign')
# {node: its command}. The two C++ nodes repeat to each other the messages about tasks that are done.
SYSTEM = {
    **{f'/robot_{i}/move_base': ['move_base', '_max_speed:=2.0', f'_start_y:={5.0 * i}'] for i in range(3)},
    '/coordinator': ['task_coordinator.py', '_tasks:=8'], '/metrics': ['way_metrics.py'],
    **{f'/robot_{i}/task_queue': ['task_queue.py'] for i in range(3)},
    '/relay': ['shim_listener', 'ticks:=/done'], '/second_relay': ['shim_listener', 'ticks:=/heard', 'heard:=/ticks']}

# The participant finds the time master by the parameter, as any node does. argv: folder, ROS master.
PARTICIPANT = """
import sys, time
sys.path.insert(0, sys.argv[1])
from lockstep_raw_client import RawClient, log
import rosgraph
master = rosgraph.Master('/away', master_uri=sys.argv[2])
while not (rosgraph.is_master_online(sys.argv[2]) and master.hasParam('/time_master/lockstep_address')):
    time.sleep(0.05)
address = master.getParam('/time_master/lockstep_address')
client = RawClient(address).hello('/away')
for leap in range({leaps}):
    grant = client.grant()
    client.report(grant, next_ns=grant.time_ns + 10 ** 9, items=log('away', 'leap', '[%d]' % leap))
client.report(client.grant(), leaving=True)
print(address, client.socket.getsockname()[0], grant.time_ns)
"""


def command_of(node):
    """Return the command line of a node of SYSTEM."""
    kind, *words = SYSTEM[node]
    program = os.path.join(FOREIGN, kind) if kind.endswith('.py') else find_executable(kind)
    above, _, own = node.rpartition('/')
    return [*([] if kind == 'move_base' else [find_executable('lockstep')]), program, *words,
            f'__ns:={above or "/"}', f'__name:={own}']


def ip(*words):
    return subprocess.run(['ip', *words], check=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


class LockstepNetworkTest(unittest.TestCase):
    def setUp(self):
        mark = f'{os.getpid()}'
        self.home, self.away = f'mba_home_{mark}', f'mba_away_{mark}'
        self.children = []
        self.folder = tempfile.mkdtemp(prefix='lockstep_network_')
        try:
            for name in (self.home, self.away):
                ip('netns', 'add', name)
                self.addCleanup(ip, 'netns', 'delete', name)
            ip('link', 'add', f'h{mark}', 'netns', self.home, 'type', 'veth', 'peer', 'name', f'a{mark}',
               'netns', self.away)
            for name, device, address in ((self.home, f'h{mark}', HOME), (self.away, f'a{mark}', AWAY)):
                ip('-n', name, 'address', 'add', f'{address}/24', 'dev', device)
                ip('-n', name, 'link', 'set', device, 'up')
                ip('-n', name, 'link', 'set', 'lo', 'up')
        except (OSError, subprocess.CalledProcessError) as error:
            self.skipTest(f'network namespaces cannot be made here: {getattr(error, "output", None) or error}')

    def tearDown(self):
        self.end_all()

    def end_all(self):
        for child in reversed(self.children):
            child.kill()
            child.wait()
        self.children.clear()

    def run_in(self, namespace, address, command, **options):
        environment = dict(os.environ, ROS_IP=address, ROS_MASTER_URI=f'http://{HOME}:{PORT}/', ROS_LOG_DIR=self.folder)
        environment.pop('ROS_HOSTNAME', None)
        child = subprocess.Popen(['ip', 'netns', 'exec', namespace, *command], env=environment, text=True, **options)
        self.children.append(child)
        return child

    def test_a_participant_on_another_computer_takes_part(self):
        uri = f'http://{HOME}:{PORT}/'
        log = os.path.join(self.folder, 'run.jsonl')
        self.run_in(self.home, HOME, ['rosmaster', '--core', '-p', str(PORT)])
        # The participant waits for the time master, so the order of the starts does not matter.
        participant = self.run_in(self.away, AWAY, [sys.executable, '-c', PARTICIPANT.format(leaps=LEAPS),
                                                    os.path.dirname(os.path.abspath(__file__)), uri],
                                  stdout=subprocess.PIPE)
        master = self.run_in(self.home, HOME, [find_executable('time_master'), '__name:=time_master', '_mode:=lockstep',
                                               '_settle:=0.5', f'_event_log:={log}', '_end_when_idle:=true'])
        out, _ = participant.communicate(timeout=GUARD)
        address, own, now = out.split()
        self.assertEqual((address.rsplit(':', 1)[0], own, int(now)), (HOME, AWAY, LEAPS * 10 ** 9))
        self.assertEqual(master.wait(GUARD), 0)
        with open(log) as stream:
            self.assertEqual(len(stream.readlines()), LEAPS + 2)

    def run_system(self, name, places, lookahead):
        """Run a system of unmodified Python and C++ nodes, each at its place in ``places``; return its events."""
        self.run_in(self.home, HOME, ['rosmaster', '--core', '-p', str(PORT)])
        setting = [sys.executable, '-c', SIM_TIME, f'http://{HOME}:{PORT}/']
        self.assertEqual(self.run_in(self.home, HOME, setting).wait(GUARD), 0)
        path = os.path.join(self.folder, name + '.jsonl')
        master = self.run_in(self.home, HOME, [
            find_executable('time_master'), '__name:=time_master', '_mode:=lockstep', f'_event_log:={path}',
            '_log_messages:=true', f'_lookahead:={lookahead}', '_end_with:=[/coordinator]',
            f'_participants:=[{", ".join(SYSTEM)}]'])
        for node, (namespace, address) in zip(SYSTEM, places):
            self.run_in(namespace, address, command_of(node), stdout=subprocess.DEVNULL)
        self.assertEqual(master.wait(GUARD), 0)
        self.end_all()
        return self.events_of(path)

    def run_here(self, lookahead):
        """Run the system on this computer, without namespaces; return its events."""
        path = os.path.join(self.folder, f'here_{lookahead}.jsonl')
        with Loopback() as ros:
            master = ros.run('time_master', 'time_master', parameters={
                'mode': 'lockstep', 'event_log': path, 'log_messages': True, 'lookahead': float(lookahead),
                'end_with': ['/coordinator'], 'participants': list(SYSTEM)})
            for node in SYSTEM:
                ros.spawn(node, command_of(node))
            self.assertEqual(master.process.wait(GUARD), 0)
        return self.events_of(path)

    def events_of(self, path):
        log, events = events_of(path)
        self.assertEqual(log.end['not_repeatable_because'] + log.end['degraded_because'], [])
        return events

    def test_a_system_on_two_computers_is_the_same_as_on_one_with_and_without_a_lookahead(self):
        here, there = (self.home, HOME), (self.away, AWAY)
        kinds = {'two': [here, there], 'other': [there, there, here], 'one': [here]}
        for lookahead in ('0.0', '0.05'):
            events = self.run_here(lookahead)
            self.assertGreater(len(events), 100)
            for name, places in list(kinds.items())[:times(1, len(kinds))]:
                of_each = (places * len(SYSTEM))[:len(SYSTEM)]
                self.assertEqual(self.run_system(f'{name}_{lookahead}', of_each, lookahead), events)
