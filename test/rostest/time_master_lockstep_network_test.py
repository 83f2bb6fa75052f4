#!/usr/bin/env python3
"""Lockstep over a network: ROS master and time master in one network namespace, a participant in another.

Two namespaces of our own with a cable (veth) between them, made and removed here. Without the right to make them, the
test is skipped and says so.
"""

import os
import subprocess
import sys
import tempfile
import unittest

import rostest

from move_base_abstract_ros.loopback import find_executable

GUARD = 60.0  # s, wall; only ends a test that would never end
HOME, AWAY = '10.213.7.1', '10.213.7.2'
LEAPS = 500
PORT = 11311

# The participant: finds the time master by the parameter, as any node does. argv: folder, ROS master.
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
        for child in reversed(self.children):
            child.kill()
            child.wait()

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


if __name__ == '__main__':
    rostest.rosrun('move_base_abstract', 'time_master_lockstep_network', LockstepNetworkTest)
