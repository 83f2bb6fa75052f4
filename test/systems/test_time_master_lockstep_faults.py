"""The time master in lockstep when something goes wrong: the nodes that it names, the rest of the run, its end.

Everything waits for events; GUARD [s, wall] only ends a test that would never end.
"""

import json
import multiprocessing
import os
import resource
import signal
import socket
import struct
from pathlib import Path

import lockstep_raw_client as raw
import rosgraph
from lockstep_run import GUARD, SECOND, START, Closed, LockstepCase, RawClient, wait_for
from warm import Loopback

LAUNCH_FILE = """
<launch>  <!-- the time master in lockstep, byte by byte: silence, death, deadlock, bad frames, no ROS master -->
  <param name="/use_sim_time" value="true"/>
</launch>
"""


def send_knocks(connection):
    """Send KNOCK until this process is ended, or the connection."""
    while True:
        connection.sendall(raw.frame(raw.KNOCK) * 1000)


class LockstepFaultsTest(LockstepCase):
    # ---- standing still ----

    def test_who_sends_without_end_instead_of_a_report_keeps_nobody_out(self):
        self.start(participants=['/a'])
        client = self.join('/a')
        client.grant()
        flood = multiprocessing.get_context('fork').Process(target=send_knocks, args=(client.socket,), daemon=True)
        flood.start()
        self.addCleanup(flood.join)
        self.addCleanup(flood.terminate)
        self.join('/b')  # it hears WELCOME within GUARD

    # ---- silence ----

    def test_a_stopped_process_is_named_with_what_it_owes_and_goes_on_when_it_continues(self):
        self.start(participants=['/a'], silence_limit=0.5)
        process = self.ticker('/a')
        self.clock.wait('some time', lambda message: message.clock.to_nsec() > 100 * SECOND)
        os.kill(process.pid, signal.SIGSTOP)
        self.wait_for_output("'/a' has been silent for")
        state = self.state.wait('the silence', lambda state: state.phase == 'waiting' and state.waiting_for)
        self.assertEqual(state.waiting_for[0].name, '/a')
        self.assertIn('wake-up due', state.waiting_for[0].owes)
        self.assertGreater(state.waiting_for[0].since, 0.4)
        os.kill(process.pid, signal.SIGCONT)
        self.wait_for_output("'/a' answered after")
        self.clock.wait('later time', lambda message: message.clock > state.sim_time)
        self.assertEqual(self.state.messages[-1].degraded_because, [])

    # ---- death ----

    def test_a_death_ends_the_run_where_that_is_wished(self):
        self.start(participants=['/a', '/b'], on_death='end', event_log=self.path('run.jsonl'))
        process = self.ticker('/a')
        client = self.join('/b')
        client.turn()
        process.kill()
        self.assertIn("'/a' died", client.end())
        self.assertEqual(self.process.wait(GUARD), 1)
        self.assertIn('FATAL', self.output())
        with open(self.path('run.jsonl')) as log:
            self.assertIn("'/a' died", log.read().splitlines()[-1])

    # ---- bad frames ----

    def test_the_reason_is_told_to_who_sent_a_bad_frame(self):
        self.start(participants=['/a', '/b'])
        client, other = self.joined('/a', '/b')
        version = raw.PROTOCOL + 1
        hello = struct.pack('<I', version) + raw.text('/x') + raw.text('') + bytes(13)
        for data, words in ((struct.pack('<I', 2 ** 31), 'length'), (struct.pack('<I', 0), 'length'),
                            (raw.frame(raw.KNOCK), 'the first frame must be HELLO'), (raw.frame(99), '99'),
                            (raw.frame(raw.HELLO, hello),
                             'protocol must be {}, got {}'.format(raw.PROTOCOL, version))):
            bad = RawClient(self.address)
            self.addCleanup(bad.close)
            bad.socket.sendall(data)
            self.assertIn(words, bad.end())
        other.knock()
        other.report(other.grant(), items=b'\xff')
        self.assertIn('255', other.end())
        state = self.state.wait('the label', lambda state: bool(state.degraded_because))
        self.assertIn("'/b'", state.degraded_because[0])
        client.knock()
        client.turn()

    # ---- the event log ----

    def test_a_full_disk_shows_in_why_the_state_and_the_log(self):
        path = self.path('run.jsonl')
        self.start(participants=['/a'], event_log=path)
        client = self.join('/a')
        self.assertEqual(self.state.messages[-1].event_log_error, '')
        size = os.path.getsize(path + '.part') + 100000
        # Like a full disk: no file can grow beyond this.
        resource.prlimit(self.process.pid, resource.RLIMIT_FSIZE, (size, size))
        client.turn(items=b''.join(raw.log('robot', 'x' * 1000, '[]') for _ in range(200)), next_ns=START + SECOND)
        words = f'event log {path}.part cannot be written: File too large; it ends there'
        state = self.state.wait('the error', lambda state: bool(state.event_log_error))
        self.assertEqual(state.event_log_error, words)
        self.wait_for_output(words)
        self.assertIn(words + '\n', self.run_script('why').stdout)
        self.assertEqual(client.turn().time_ns, START + SECOND)  # the run goes on
        self.assertEqual(self.end(), 1)
        self.assertEqual((os.path.exists(path), os.path.getsize(path + '.part')), (False, size))

    def test_what_is_no_event_log_is_not_replaced(self):
        path = Path(self.path('run.jsonl'))
        path.write_text('my thesis')
        self.launch(mode='lockstep', event_log=str(path))
        self.assertEqual(self.process.wait(GUARD), 1)
        self.assertIn(f"event_log must be a path that can be written, got '{path}': {path} is there already and is no "
                      'event log', self.output())
        self.assertEqual(path.read_text(), 'my thesis')

    # ---- strangers ----

    def test_strangers_are_few_and_small_and_make_room_when_they_go(self):
        self.start(participants=['/a'])
        host, port = self.address.rsplit(':', 1)
        strangers = [socket.create_connection((host, int(port)), GUARD) for _ in range(300)]
        for stranger in strangers:
            self.addCleanup(stranger.close)
        wait_for('the first ones taken', lambda: self.descriptors() >= 256)
        client = RawClient(self.address)  # waits in the kernel's queue
        self.addCleanup(client.close)
        self.assertLess(self.descriptors(), 300)
        strangers[0].sendall(struct.pack('<I', 4097))
        self.assertIn(b'length must be from 1 to 4096, got 4097', strangers[0].recv(1000))
        for stranger in strangers:
            stranger.close()
        client.hello('/a').turn()
        self.assertEqual([one.name for one in self.state.wait('it', lambda state: state.participants).participants],
                         ['/a'])

    def descriptors(self):
        return len(os.listdir(f'/proc/{self.process.pid}/fd'))

    # ---- the ROS master ----

    def test_when_the_ros_master_dies_the_run_ends_and_its_log_is_closed(self):
        path = self.path('run.jsonl')
        with Loopback() as ros:
            parameters = dict(mode='lockstep', participants=['/a'], event_log=path)
            child = ros.run('time_master', 'time_master', parameters=parameters)
            rosmaster = rosgraph.Master('/test', master_uri=ros.uri)
            self.address = raw.address_at(ros.uri)
            client = self.join('/a')
            client.turn(items=raw.log('robot', 'goal', '[1]'))
            os.kill(rosmaster.getPid(), signal.SIGKILL)
            self.assertIn('the ROS master at', client.end())
            self.assertEqual(child.process.wait(GUARD), 1)
        with open(path) as log:
            lines = log.read().splitlines()
        self.assertEqual(len(lines), 3)
        end = json.loads(lines[-1])['end']
        self.assertIn('the ROS master at', end['reason'])
        self.assertTrue(end['by_fault'])
        self.assertFalse(end['repeatable'])
        self.assertIn('the ROS master was lost', end['not_repeatable_because'][0])
        self.assertIn('the ROS master at', end['degraded_because'][0])

    # ---- strict ----

    def test_where_it_is_strict_the_first_label_ends_the_run(self):
        self.start(participants=['/a', '/b'], strict=True, event_log=self.path('run.jsonl'))
        first, other = self.joined('/a', '/b')
        first.socket.sendall(raw.frame(raw.KNOCK))
        self.assertIn("strict, and the run is not repeatable: '/a' had input from outside", other.end())
        self.assertEqual(self.process.wait(GUARD), 1)
        self.assertIn('strict, and the run is not repeatable', self.output())
        self.assertIn('"by_fault":true', Path(self.path('run.jsonl')).read_text())

    def test_a_time_master_that_was_killed_leaves_an_unfinished_log_and_no_address_to_the_next(self):
        self.start(participants=['/a'], event_log=self.path('run.jsonl'))
        client = self.join('/a')
        client.turn(items=raw.log('robot', 'goal', '[1]'))
        part = self.path('run.jsonl.part')
        wait_for('the event on the disk', lambda: Path(part).read_text().count('\n') == 2)
        self.process.kill()
        self.process.wait()
        with self.assertRaises(Closed):
            client.grant()
        self.assertFalse(os.path.exists(self.path('run.jsonl')))
        stale = self.master.getParam('/time_master/lockstep_address')
        self.launch(mode='scaled', lockstep_address=stale)
        wait_for('the old address gone', lambda: not self.master.hasParam('/time_master/lockstep_address'))
        self.assertNotIn('unknown', self.output())

