"""A time master in lockstep for the tests that speak its protocol byte by byte.

Each test starts a time master of its own as a child process under the test file's ROS master, and ends it. The test's
own node does not use ROS time, since otherwise it would be an onlooker that listens to /clock.
"""

import os
import signal
import subprocess
import sys
import tempfile
import unittest

import rosgraph
import rospy
from lockstep_raw_client import NEVER, Closed, RawClient, address_at
from robot_harness import Record
from rosgraph_msgs.msg import Clock
from waiting import GUARD, wait_for

from move_base_abstract.msg import TimeState
from move_base_abstract_ros.loopback import find_executable

SECOND = 10 ** 9
START = SECOND  # ns, the first instant

# A participant in a process of its own: it takes part until it is killed. argv: address, name, period [ns].
TICKER = """
import sys
sys.path.insert(0, {folder!r})
from lockstep_raw_client import Closed, RawClient
client = RawClient(sys.argv[1]).hello(sys.argv[2])
print('joined', flush=True)
try:
    while True:
        grant = client.grant(3600.0)
        client.report(grant, next_ns=grant.time_ns + int(sys.argv[3]))
except Closed:
    pass
"""


class Messages(Record):
    """A record of which one waits for the last message or a later one."""

    def wait(self, what, wanted):
        """Return the last message or the first one from now on for which wanted(message) is true."""
        return self.wait_for(wanted, what, max(0, len(self.messages) - 1))


class LockstepCase(unittest.TestCase):
    """A test case with a time master for each test, which start() starts."""

    def setUp(self):
        if not rospy.core.is_initialized():
            rospy.init_node('lockstep_test', anonymous=True, disable_rostime=True, disable_signals=True)
        self.folder = tempfile.mkdtemp(prefix='lockstep_test_', dir=os.environ.get('ROS_HOME'))
        self.master = rosgraph.Master(rospy.get_name())
        self.process = None
        self.state = None
        self.clock = None
        self.others = []  # processes

    def tearDown(self):
        for topic in (self.state, self.clock):
            if topic is not None:
                topic.close()
        for process in [*self.others, self.process]:
            if process is not None and process.poll() is None:
                process.send_signal(signal.SIGCONT)
                process.kill()
                process.wait()

    def path(self, name):
        return os.path.join(self.folder, name)

    def start(self, mode='lockstep', **parameters):
        """Start a time master and listen to it; return this case, whose ``address`` is set in lockstep."""
        self.launch(mode=mode, **parameters)
        self.state = Messages('/time_master/state', TimeState)
        self.clock = Messages('/clock', Clock)
        self.state.wait('any state', lambda state: True)
        if mode == 'lockstep':
            self.address = self.address_now()
        return self

    def launch(self, **parameters):
        """Start the process with these parameters and no others."""
        if self.master.hasParam('/time_master'):
            self.master.deleteParam('/time_master')
        for key, value in parameters.items():
            self.master.setParam('/time_master/' + key, value)
        environment = dict(os.environ, ROSCONSOLE_STDOUT_LINE_BUFFERED='1')
        with open(self.path('time_master.out'), 'wb') as out:
            self.process = subprocess.Popen([find_executable('time_master'), '__name:=time_master'], stdout=out,
                                            stderr=subprocess.STDOUT, env=environment, cwd=self.folder)

    def address_now(self):
        return address_at(os.environ['ROS_MASTER_URI'])

    def output(self):
        with open(self.path('time_master.out'), errors='replace') as out:
            return out.read()

    def wait_for_output(self, words):
        wait_for(f"'{words}' in the log", lambda: words in self.output())

    def end(self, number=signal.SIGTERM):
        """End the time master by a signal and return its exit code."""
        self.process.send_signal(number)
        return self.process.wait(GUARD)

    def join(self, name, **hello):
        client = RawClient(self.address).hello(name, **hello)
        self.addCleanup(client.close)
        return client

    def joined(self, *names):
        """Join these participants, report on their first grants, and return their clients."""
        clients = [self.join(name) for name in names]
        for client in clients:
            client.turn()
        return clients

    def ticker(self, name, period=SECOND):
        """Start a participant in another process."""
        process = subprocess.Popen([sys.executable, '-c', TICKER.format(folder=os.path.dirname(__file__)), self.address,
                                    name, str(period)], stdout=subprocess.PIPE, text=True)
        self.others.append(process)
        self.addCleanup(process.stdout.close)
        self.assertEqual(process.stdout.readline(), 'joined\n')
        return process

    def call(self, service, kind, *arguments):
        name = '/time_master/' + service
        rospy.wait_for_service(name, GUARD)
        return rospy.ServiceProxy(name, kind)(*arguments)

    def times(self):
        return [message.clock.to_nsec() for message in self.clock.messages]

    def assert_no_grant(self, client, wall=0.3):
        """Assert that no grant comes within ``wall`` [s, wall]; one would come within a millisecond."""
        with self.assertRaises(OSError):
            client.grant(wall)

    def run_script(self, name, *arguments):
        """Run a program of the package to its end; return what subprocess.run returns."""
        command = [sys.executable, find_executable(name), *arguments]
        return subprocess.run(command, check=False, timeout=GUARD, text=True, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE)


__all__ = ['GUARD', 'NEVER', 'SECOND', 'START', 'Closed', 'LockstepCase', 'Messages', 'RawClient', 'wait_for']
